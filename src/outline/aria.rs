//! The terms of ARIA for the roles and states of widgets.

use eframe::egui::accesskit::{Action, Node, Role, Toggled};

/// Returns the ARIA role of a node; none for a container that tells nothing of its contents.
pub(super) fn aria_role(node: &Node, has_name: bool) -> Option<&'static str> {
    Some(match node.role() {
        Role::Label | Role::Paragraph => "text",
        Role::TextInput | Role::MultilineTextInput | Role::SearchInput | Role::NumberInput => {
            "edit"
        }
        Role::Button | Role::DefaultButton | Role::DisclosureTriangle => "button",
        Role::CheckBox => "checkbox",
        Role::Switch => "switch",
        Role::RadioButton => "radio",
        Role::RadioGroup => "radiogroup",
        Role::ComboBox => "combobox",
        Role::Slider => "slider",
        Role::SpinButton => "spinbutton",
        Role::ProgressIndicator => "progressbar",
        Role::Meter => "meter",
        Role::Link => "link",
        Role::Image | Role::Canvas => "img",
        Role::Heading => "heading",
        Role::Tab => "tab",
        Role::TabList => "tablist",
        Role::Menu => "menu",
        Role::MenuItem if node.toggled().is_none() => "menuitem",
        Role::MenuItem | Role::MenuItemRadio => "menuitemradio",
        Role::MenuItemCheckBox => "menuitemcheckbox",
        Role::List => "list",
        Role::ListItem => "listitem",
        Role::ListBox => "listbox",
        Role::ListBoxOption => "option",
        Role::Tree => "tree",
        Role::TreeItem => "treeitem",
        Role::Table => "table",
        Role::Row => "row",
        Role::Cell => "cell",
        Role::ColumnHeader => "columnheader",
        Role::Dialog | Role::Window => "dialog",
        Role::AlertDialog => "alertdialog",
        Role::Alert => "alert",
        Role::Status => "status",
        Role::Tooltip => "tooltip",
        Role::Toolbar => "toolbar",
        Role::Banner => "banner",
        Role::Navigation => "navigation",
        Role::Main => "main",
        Role::Complementary => "complementary",
        Role::Form => "form",
        Role::Article => "article",
        Role::Region => "region",
        // A thing that can be pressed is a button, whatever it is called.
        _ if node.supports_action(Action::Click) && has_name => "button",
        _ if has_name => "group",
        _ => return None,
    })
}

/// Returns the attribute that says whether an element is on, and its value.
pub(super) fn state(node: &Node, role: &str) -> Option<(&'static str, &'static str)> {
    let value = match (node.toggled(), node.is_selected()) {
        (Some(Toggled::True), _) | (None, Some(true)) => "true",
        (Some(Toggled::False), _) | (None, Some(false)) => "false",
        (Some(Toggled::Mixed), _) => "mixed",
        (None, None) => return None,
    };
    let attribute = match role {
        "tab" | "option" | "treeitem" | "row" => "aria-selected",
        "checkbox" | "switch" | "radio" | "menuitemradio" | "menuitemcheckbox" => "aria-checked",
        "button" => "aria-pressed",
        _ => return None,
    };
    Some((attribute, value))
}
