//! The macros of `segue-text`, which re-exports and documents them.

mod template;

use proc_macro2::{Ident, Literal, TokenStream, TokenTree};
use quote::{format_ident, quote};
use syn::parse::{Parse, ParseStream};
use syn::{Data, DeriveInput, Fields, LitStr, Token};

/// Makes a `Message` of a template and its arguments, with the syntax of `format!`: a name without
/// a value takes the variable of that name.
#[proc_macro]
pub fn msg(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let text = syn::parse_macro_input!(input as Text);
    message(&text, &[]).unwrap_or_else(syn::Error::into_compile_error).into()
}

/// Implements `ToMessage` by the `#[error("…")]` of a struct, or of each variant of an enum.
#[proc_macro_derive(ToMessage, attributes(error))]
pub fn to_message(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = syn::parse_macro_input!(input as DeriveInput);
    implementation(&input).unwrap_or_else(syn::Error::into_compile_error).into()
}

/// A template and the values of its names, as written in the code.
struct Text {
    template: LitStr,
    args: Vec<(Ident, TokenStream)>,
}

impl Parse for Text {
    fn parse(input: ParseStream) -> syn::Result<Self> {
        let template: LitStr = input.parse()?;
        let mut args = Vec::new();
        while !input.is_empty() {
            input.parse::<Token![,]>()?;
            if input.is_empty() {
                break;
            }
            let name: Ident = input.parse()?;
            let mut value = TokenStream::new();
            if input.peek(Token![=]) {
                input.parse::<Token![=]>()?;
                while !input.is_empty() && !input.peek(Token![,]) {
                    value.extend([input.parse::<TokenTree>()?]);
                }
            } else {
                value = quote!(#name);
            }
            args.push((name, value));
        }
        Ok(Self { template, args })
    }
}

/// Returns the expression of a message. Names that are neither in `fields` nor given are variables
/// in scope.
fn message(text: &Text, fields: &[Field]) -> syn::Result<TokenStream> {
    let Text { template, args } = text;
    let written = template.value();
    let names = template::names(&written).map_err(|why| syn::Error::new(template.span(), why))?;
    if let Some((name, _)) = args.iter().find(|(name, _)| !names.iter().any(|n| name == n)) {
        return Err(syn::Error::new(name.span(), "the template does not use this argument"));
    }
    let values = names.iter().map(|name| {
        if let Some((_, value)) = args.iter().find(|(given, _)| given == name) {
            return with_fields(value.clone(), fields);
        }
        let binding = fields.iter().find(|field| field.name == *name).map(|field| &field.binding);
        let ident = binding.cloned().unwrap_or_else(|| Ident::new(name, template.span()));
        quote!(#ident)
    });
    let pairs = names
        .iter()
        .zip(values)
        .map(|(name, value)| quote!((::std::borrow::Cow::Borrowed(#name), (#value).to_arg())));
    Ok(if names.is_empty() {
        quote!(::segue_text::Message::word(#template))
    } else {
        quote!({
            use ::segue_text::ToArg as _;
            ::segue_text::Message::new(#template, ::std::vec![#(#pairs),*])
        })
    })
}

/// A field of a struct or variant: its name in templates, and the variable it is bound to.
struct Field {
    name: String,
    binding: Ident,
}

/// Returns the expression with `.field` and `.0` replaced by the variables of these fields, as in
/// `thiserror`.
fn with_fields(value: TokenStream, fields: &[Field]) -> TokenStream {
    let mut tokens = value.into_iter().peekable();
    let mut whole = TokenStream::new();
    let mut begins = true;
    while let Some(token) = tokens.next() {
        let field = match (&token, tokens.peek()) {
            (TokenTree::Punct(point), Some(next)) if begins && point.as_char() == '.' => {
                let name = next.to_string();
                fields.iter().find(|field| field.name == name)
            }
            _ => None,
        };
        let token = match (field, token) {
            (Some(field), _) => {
                tokens.next();
                TokenTree::Ident(field.binding.clone())
            }
            (None, TokenTree::Group(group)) => {
                let inside = with_fields(group.stream(), fields);
                TokenTree::Group(proc_macro2::Group::new(group.delimiter(), inside))
            }
            (None, token) => token,
        };
        begins = matches!(token, TokenTree::Punct(_));
        whole.extend([token]);
    }
    whole
}

/// Returns whether an expression mentions a variable or field.
fn mentions(value: &TokenStream, field: &Field) -> bool {
    value.clone().into_iter().any(|token| match token {
        TokenTree::Group(group) => mentions(&group.stream(), field),
        TokenTree::Ident(ident) => ident == field.name,
        TokenTree::Literal(literal) => literal.to_string() == field.name,
        TokenTree::Punct(_) => false,
    })
}

fn implementation(input: &DeriveInput) -> syn::Result<TokenStream> {
    let name = &input.ident;
    let (generics, type_generics, conditions) = input.generics.split_for_impl();
    let arms: Vec<TokenStream> = match &input.data {
        Data::Struct(data) => vec![arm(&quote!(Self), &data.fields, &input.attrs, name)?],
        Data::Enum(data) => (data.variants.iter())
            .map(|variant| {
                let ident = &variant.ident;
                arm(&quote!(Self::#ident), &variant.fields, &variant.attrs, ident)
            })
            .collect::<syn::Result<_>>()?,
        Data::Union(_) => {
            return Err(syn::Error::new(name.span(), "a union has no message"));
        }
    };
    Ok(quote! {
        #[automatically_derived]
        impl #generics ::segue_text::ToMessage for #name #type_generics #conditions {
            fn to_message(&self) -> ::segue_text::Message {
                match self { #(#arms)* }
            }
        }
        #[automatically_derived]
        impl #generics ::segue_text::ToArg for #name #type_generics #conditions {
            fn to_arg(&self) -> ::segue_text::Arg {
                ::segue_text::Arg::Message(::segue_text::ToMessage::to_message(self))
            }
        }
    })
}

/// Returns the match arm of a variant, or of a struct.
fn arm(
    path: &TokenStream,
    fields: &Fields,
    attrs: &[syn::Attribute],
    name: &Ident,
) -> syn::Result<TokenStream> {
    let Some(attr) = attrs.iter().find(|attr| attr.path().is_ident("error")) else {
        return Err(syn::Error::new(name.span(), "it has no `#[error(\"…\")]`"));
    };
    let bound: Vec<Field> = (fields.iter().enumerate())
        .map(|(index, field)| match &field.ident {
            Some(ident) => Field { name: ident.to_string(), binding: ident.clone() },
            None => Field { name: index.to_string(), binding: format_ident!("field_{index}") },
        })
        .collect();
    let is_transparent = attr.parse_args::<Ident>().is_ok_and(|word| word == "transparent");
    if is_transparent {
        let pattern = pattern(fields, &bound, |field| field.name == "0");
        return Ok(quote!(#path #pattern => ::segue_text::ToMessage::to_message(field_0),));
    }
    let text: Text = attr.parse_args()?;
    let message = message(&text, &bound)?;
    let names = template::names(&text.template.value()).unwrap_or_default();
    let pattern = pattern(fields, &bound, |field| {
        let is_given = text.args.iter().any(|(name, _)| *name == field.name);
        names.contains(&field.name) && !is_given
            || text.args.iter().any(|(_, value)| mentions(value, field))
    });
    Ok(quote!(#path #pattern => #message,))
}

/// Returns the pattern that binds the fields that are used.
fn pattern(fields: &Fields, bound: &[Field], is_used: impl Fn(&Field) -> bool) -> TokenStream {
    let used = bound.iter().filter(|field| is_used(field));
    let entries = used.map(|field| {
        let binding = &field.binding;
        if let Ok(index) = field.name.parse::<usize>() {
            let index = Literal::usize_unsuffixed(index);
            quote!(#index: #binding,)
        } else {
            quote!(#binding,)
        }
    });
    if matches!(fields, Fields::Unit) { TokenStream::new() } else { quote!({ #(#entries)* .. }) }
}
