//! Tests of the division, with a module that has a function of each kind.

use super::*;
use walrus::{GlobalId, ImportKind, MemoryId};

/// A module with a function of each kind. `first` is exported and calls `rest::big`, `shared`
/// and, through the table, `rest::listed`; `rest::big` calls `shared`, `helper`, which nothing
/// else calls, and a function of the page.
struct Sample {
    module: Module,
    memory: MemoryId,
    counter: GlobalId,
}

impl Sample {
    fn new() -> Self {
        let mut module = Module::default();
        let memory = module.memories.add_local(false, false, 1, None, None);
        module.exports.add("memory", memory);
        let zero = ConstExpr::Value(Value::I32(0));
        let counter = module.globals.add_local(ValType::I32, true, false, zero.clone());
        let mut sample = Self { module, memory, counter };
        let page = sample.module.types.add(&[], &[]);
        let (page, _) = sample.module.add_import_func("page", "log", page);
        let shared = sample.function("shared", 1, &[]);
        let helper = sample.function("helper", 1, &[]);
        let big = sample.function("rest::big", MIN_SIZE, &[shared, helper, page]);
        let listed = sample.function("rest::listed", MIN_SIZE, &[]);
        let small = sample.function("rest::small", 1, &[]);
        let first = sample.function("first", 1, &[big, shared, small]);
        sample.module.exports.add("first", first);
        let table = sample.module.tables.add_local(false, 4, Some(4), RefType::FUNCREF);
        fill(&mut sample.module, table, 1, vec![first, listed, big]);
        sample.module.exports.add("table", table);
        sample
    }

    /// Adds a function that counts `size` times and calls others.
    fn function(&mut self, name: &str, size: u64, callees: &[FunctionId]) -> FunctionId {
        let params = [ValType::I32, ValType::F64];
        let arg = self.module.locals.add(ValType::I32);
        let other = self.module.locals.add(ValType::F64);
        let mut made = FunctionBuilder::new(&mut self.module.types, &params, &[ValType::I32]);
        let mut body = made.name(name.to_owned()).func_body();
        for _ in 0..size {
            body.local_get(arg).global_set(self.counter);
        }
        let address = ir::MemArg { align: 4, offset: 0 };
        body.i32_const(0).load(self.memory, ir::LoadKind::I32 { atomic: false }, address).drop();
        for callee in callees {
            if self.module.types.params(self.module.funcs.get(*callee).ty()).is_empty() {
                body.call(*callee);
            } else {
                body.local_get(arg).local_get(other).call(*callee).drop();
            }
        }
        body.global_get(self.counter);
        made.finish(vec![arg, other], &mut self.module.funcs)
    }

    fn with_fetch(mut self) -> Self {
        let mut fetch = FunctionBuilder::new(&mut self.module.types, &[], &[]);
        fetch.func_body();
        let fetch = fetch.finish(Vec::new(), &mut self.module.funcs);
        self.module.exports.add(FETCH_REST, fetch);
        self
    }
}

fn list() -> List {
    "rest".parse().unwrap_or_else(|never| match never {})
}

/// Returns the names and kinds of what the rest imports from the first part.
fn imports_of(rest: &Module) -> Vec<(String, &'static str)> {
    let imports = rest.imports.iter().map(|import| {
        assert_eq!(import.module, FIRST);
        let kind = match import.kind {
            ImportKind::Function(_) => "function",
            ImportKind::Table(_) => "table",
            ImportKind::Memory(_) => "memory",
            ImportKind::Global(_) => "global",
            ImportKind::Tag(_) => "tag",
        };
        (import.name.clone(), kind)
    });
    imports.collect()
}

/// Returns the names and kinds of what the first part exports.
fn exports_of(first: &Module) -> Vec<(String, &'static str)> {
    let exports = first.exports.iter().map(|export| {
        let kind = match export.item {
            ExportItem::Function(_) => "function",
            ExportItem::Table(_) => "table",
            ExportItem::Memory(_) => "memory",
            ExportItem::Global(_) => "global",
            ExportItem::Tag(_) => "tag",
        };
        (export.name.clone(), kind)
    });
    exports.collect()
}

#[test]
fn split_moves_named_functions_and_what_they_alone_call() -> Result<()> {
    let whole = Sample::new().with_fetch().module.emit_wasm();
    let Parts::Two { first, rest } = split(&whole, &list(), false)? else {
        bail!("it was not divided");
    };
    // Parsing validates both.
    let [first, rest] = [Module::from_buffer(&first)?, Module::from_buffer(&rest)?];
    // first, shared, rest::small, what fetches, what asks whether that is needed, two stubs.
    assert_eq!(first.funcs.iter_local().count(), 7);
    // rest::big, rest::listed, helper, and what notes that they are there.
    assert_eq!(rest.funcs.iter_local().count(), 4);
    assert!(rest.start.is_some() && rest.data.iter().next().is_none());
    // The page's function and `shared`; the memory; the table and that of the stubs; the
    // counter, and whether the rest is there.
    let imports = imports_of(&rest);
    let count = |kind: &str| imports.iter().filter(|(_, other)| *other == kind).count();
    assert_eq!(["function", "memory", "table", "global"].map(count), [2, 1, 2, 2]);
    let exports = exports_of(&first);
    assert!(imports.iter().all(|import| exports.contains(import)), "{imports:?} {exports:?}");
    for name in ["memory", "first", "table", FETCH_REST] {
        assert!(exports.iter().any(|(export, _)| export == name), "{name}");
    }
    Ok(())
}

#[test]
fn split_fills_the_places_of_its_functions() -> Result<()> {
    let whole = Sample::new().with_fetch().module.emit_wasm();
    let Parts::Two { rest, .. } = split(&whole, &list(), false)? else {
        bail!("it was not divided");
    };
    let rest = Module::from_buffer(&rest)?;
    let filled: Vec<(i32, usize)> = rest
        .elements
        .iter()
        .filter_map(|element| match (&element.kind, &element.items) {
            (
                ElementKind::Active { offset: ConstExpr::Value(Value::I32(offset)), .. },
                ElementItems::Functions(functions),
            ) => Some((*offset, functions.len())),
            _ => None,
        })
        .collect();
    assert_eq!(filled, [(2, 2), (0, 2)], "the table behind `first`, and that of the stubs");
    Ok(())
}

#[test]
fn split_without_a_way_to_fetch_keeps_the_module_whole() -> Result<()> {
    let whole = Sample::new().module.emit_wasm();
    let Parts::Whole(same) = split(&whole, &list(), false)? else {
        bail!("it was divided");
    };
    let same = Module::from_buffer(&same)?;
    assert_eq!(same.funcs.iter_local().count(), 6);
    assert!(same.funcs.iter().all(|function| function.name.is_none()));
    Ok(())
}

#[test]
fn short_names_differ() {
    let names: HashSet<String> = (0..10_000).map(short_name).collect();
    assert_eq!(names.len(), 10_000);
    assert!(names.iter().all(|name| name.len() <= 3));
}
