//! Divides a module in two: what draws the first frames, and the rest, which comes behind them.
//!
//! Both parts are instances that share everything: the rest imports the memory, the tables, the
//! globals and the functions of the first. A function of the rest that the first refers to is
//! replaced there by a stub, which calls the real one through a table that the rest fills when it
//! is instantiated. A stub that is called before that asks the page for the rest
//! ([`FETCH_REST`]), which must then be there when the call returns: so the program is the same at
//! every moment, only slower in that one.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use anyhow::{Result, bail};
use walrus::ir::{self, Value, Visitor, dfs_in_order};
use walrus::{
    ConstExpr, ElementItems, ElementKind, ExportItem, FunctionBuilder, FunctionId, FunctionKind,
    GlobalKind, ImportedFunction, InstrSeqBuilder, LocalId, Module, ModuleConfig, RefType, TableId,
    ValType, passes,
};

use crate::list::List;

/// The exported function of the module that fetches the rest, without parameters or results.
pub(crate) const FETCH_REST: &str = "seguehandle_fetchRest";
/// The name by which the rest imports from the first part.
const FIRST: &str = "first";

/// The number of instructions from which on a function is worth a stub.
const MIN_SIZE: u64 = 50;

/// A module as it is deployed.
pub(crate) enum Parts {
    /// One that has no export [`FETCH_REST`].
    Whole(Vec<u8>),
    Two {
        /// The part that is instantiated first, with the imports and exports of the whole module.
        first: Vec<u8>,
        /// The part that is instantiated with the exports of the first, as the module `first`.
        rest: Vec<u8>,
    },
}

/// Divides a module. What only functions of the list call goes with them into the rest. Without
/// their names, a tenth less travels.
pub(crate) fn split(module: &[u8], list: &List, has_names: bool) -> Result<Parts> {
    let mut first = parse(module, has_names)?;
    let Ok(fetch) = first.exports.get_func(FETCH_REST) else {
        return Ok(Parts::Whole(first.emit_wasm()));
    };
    let plan = Plan::new(&first, list)?;
    let names = plan.make_first(&mut first, fetch)?;
    let mut rest = parse(module, has_names)?;
    plan.make_rest(&mut rest, &names);
    passes::gc::run(&mut first);
    passes::gc::run(&mut rest);
    Ok(Parts::Two { first: first.emit_wasm(), rest: rest.emit_wasm() })
}

/// Parses a module, which is to be written with the names of its functions or without them, and
/// without what only tools read.
fn parse(module: &[u8], has_names: bool) -> Result<Module> {
    let mut module = ModuleConfig::new()
        .generate_name_section(has_names)
        .generate_producers_section(false)
        .parse(module)?;
    let customs: Vec<_> = module.customs.iter().map(|(id, _)| id).collect();
    for id in customs {
        module.customs.delete(id);
    }
    Ok(module)
}

/// What goes where. Functions are identified by their index, which is the same in each copy of the
/// parsed module.
struct Plan {
    /// The functions of the rest that the first part refers to, with the index of each in the table
    /// of the stubs.
    stubs: BTreeMap<usize, usize>,
    /// All functions of the rest.
    rest: HashSet<usize>,
    /// The functions of the first part that the rest calls.
    shared: Vec<usize>,
}

impl Plan {
    fn new(module: &Module, list: &List) -> Result<Self> {
        let callees: HashMap<usize, Vec<usize>> = module
            .funcs
            .iter()
            .map(|function| (function.id().index(), callees(function)))
            .collect();
        let named: HashSet<usize> = module
            .funcs
            .iter_local()
            .filter(|(id, local)| {
                local.size() >= MIN_SIZE
                    && module.funcs.get(*id).name.as_deref().is_some_and(|name| list.has(name))
            })
            .map(|(id, _)| id.index())
            .collect();
        let roots = roots(module)?;
        // All that can be reached without the named functions is the first part's.
        let mut first = HashSet::new();
        let mut pending: Vec<usize> =
            roots.iter().copied().filter(|index| !named.contains(index)).collect();
        while let Some(index) = pending.pop() {
            if first.insert(index) {
                pending.extend(callees[&index].iter().filter(|callee| !named.contains(callee)));
            }
        }
        let rest: HashSet<usize> = (module.funcs.iter_local())
            .map(|(id, _)| id.index())
            .filter(|index| !first.contains(index))
            .collect();
        let of_first = first.iter().flat_map(|index| &callees[index]).chain(&roots);
        let stubs: BTreeSet<usize> =
            of_first.copied().filter(|index| rest.contains(index)).collect();
        let mut shared: Vec<usize> = rest
            .iter()
            .flat_map(|index| &callees[index])
            .copied()
            .filter(|callee| !rest.contains(callee))
            .collect();
        shared.sort_unstable();
        shared.dedup();
        let stubs = stubs.into_iter().enumerate().map(|(slot, index)| (index, slot)).collect();
        Ok(Self { stubs, rest, shared })
    }

    /// Turns the whole module into the first part; returns the names under which it exports what
    /// the rest imports.
    fn make_first(&self, module: &mut Module, fetch: FunctionId) -> Result<Names> {
        if self.rest.contains(&fetch.index()) {
            bail!("what fetches the rest is in the rest");
        }
        let slots = self.stubs.len() as u64;
        let table = module.tables.add_local(false, slots, Some(slots), RefType::FUNCREF);
        let is_there =
            module.globals.add_local(ValType::I32, true, false, ConstExpr::Value(Value::I32(0)));
        let mut ensure = FunctionBuilder::new(&mut module.types, &[], &[]);
        ensure.func_body().global_get(is_there).unop(ir::UnaryOp::I32Eqz).if_else(
            None,
            |then| {
                then.call(fetch);
            },
            |_| {},
        );
        let ensure = ensure.finish(Vec::new(), &mut module.funcs);
        let ids = ids(module);
        for (index, slot) in &self.stubs {
            let id = ids[index];
            let ty = module.funcs.get(id).ty();
            let signature = module.types.get(ty);
            let (params, results) = (signature.params().to_vec(), signature.results().to_vec());
            let args: Vec<LocalId> = params.iter().map(|ty| module.locals.add(*ty)).collect();
            let mut stub = FunctionBuilder::new(&mut module.types, &params, &results);
            let mut body: InstrSeqBuilder = stub.func_body();
            body.call(ensure);
            for arg in &args {
                body.local_get(*arg);
            }
            body.i32_const(*slot as i32).call_indirect(ty, table);
            module.funcs.get_mut(id).kind = FunctionKind::Local(stub.local_func(args));
        }
        Ok(self.export_shared(module, table, is_there))
    }

    fn export_shared(
        &self,
        module: &mut Module,
        stubs: TableId,
        is_there: walrus::GlobalId,
    ) -> Names {
        let ids = ids(module);
        let mut taken: HashSet<String> =
            module.exports.iter().map(|export| export.name.clone()).collect();
        let mut count = 0;
        let mut export = |module: &mut Module, item: ExportItem| {
            let name = loop {
                let name = short_name(count);
                count += 1;
                if taken.insert(name.clone()) {
                    break name;
                }
            };
            module.exports.add(&name, item);
            name
        };
        let memories: Vec<_> = module.memories.iter().map(walrus::Memory::id).collect();
        let tables: Vec<_> =
            module.tables.iter().map(walrus::Table::id).filter(|id| *id != stubs).collect();
        let globals: Vec<_> =
            module.globals.iter().map(walrus::Global::id).filter(|id| *id != is_there).collect();
        Names {
            stubs: export(module, stubs.into()),
            is_there: export(module, is_there.into()),
            memories: memories.into_iter().map(|id| export(module, id.into())).collect(),
            tables: tables.into_iter().map(|id| export(module, id.into())).collect(),
            globals: globals.into_iter().map(|id| export(module, id.into())).collect(),
            functions: (self.shared.iter())
                .map(|index| (*index, export(module, ids[index].into())))
                .collect(),
        }
    }

    /// Turns the whole module into the rest.
    fn make_rest(&self, module: &mut Module, names: &Names) {
        let ids = ids(module);
        let exports: Vec<_> = module.exports.iter().map(walrus::Export::id).collect();
        for id in exports {
            module.exports.delete(id);
        }
        module.start = None;
        Self::import_shared(module, names);
        let data: Vec<_> = module.data.iter().map(walrus::Data::id).collect();
        for id in data {
            module.data.delete(id);
        }

        // The real functions take the places of their stubs in the tables.
        let elements: Vec<_> = module.elements.iter().map(walrus::Element::id).collect();
        for id in elements {
            let element = module.elements.get(id);
            let (kind, items) = (element.kind.clone(), element.items.clone());
            module.elements.delete(id);
            let ElementKind::Active { table, offset: ConstExpr::Value(Value::I32(offset)) } = kind
            else {
                continue;
            };
            module.tables.get_mut(table).elem_segments.remove(&id);
            let ElementItems::Functions(functions) = items else { continue };
            let is_rest = |function: &FunctionId| self.rest.contains(&function.index());
            let mut place = 0;
            for run in functions.chunk_by(|one, other| is_rest(one) == is_rest(other)) {
                if is_rest(&run[0]) {
                    fill(module, table, offset + place, run.to_vec());
                }
                place += run.len() as i32;
            }
        }
        let slots = self.stubs.len() as u64;
        let (table, _) = module.add_import_table(
            FIRST,
            &names.stubs,
            false,
            slots,
            Some(slots),
            RefType::FUNCREF,
        );
        fill(module, table, 0, self.stubs.keys().map(|index| ids[index]).collect());

        let (is_there, _) =
            module.add_import_global(FIRST, &names.is_there, ValType::I32, true, false);
        let mut start = FunctionBuilder::new(&mut module.types, &[], &[]);
        start.func_body().i32_const(1).global_set(is_there);
        module.start = Some(start.finish(Vec::new(), &mut module.funcs));
    }

    fn import_shared(module: &mut Module, names: &Names) {
        let ids = ids(module);
        for (index, name) in &names.functions {
            let id = ids[index];
            let function = module.funcs.get(id);
            if let FunctionKind::Import(import) = &function.kind {
                let import = module.imports.get_mut(import.import);
                (import.module, import.name) = (FIRST.to_owned(), name.clone());
                continue;
            }
            let ty = function.ty();
            let import = module.imports.add(FIRST, name, id);
            module.funcs.get_mut(id).kind = FunctionKind::Import(ImportedFunction { import, ty });
        }
        let memories: Vec<_> = module.memories.iter().map(walrus::Memory::id).collect();
        for (id, name) in memories.into_iter().zip(&names.memories) {
            let import = module.imports.add(FIRST, name, id);
            let memory = module.memories.get_mut(id);
            memory.import = Some(import);
            memory.data_segments.clear();
        }
        let tables: Vec<_> = module.tables.iter().map(walrus::Table::id).collect();
        for (id, name) in tables.into_iter().zip(&names.tables) {
            let import = module.imports.add(FIRST, name, id);
            module.tables.get_mut(id).import = Some(import);
        }
        let globals: Vec<_> = module.globals.iter().map(walrus::Global::id).collect();
        for (id, name) in globals.into_iter().zip(&names.globals) {
            let import = module.imports.add(FIRST, name, id);
            module.globals.get_mut(id).kind = GlobalKind::Import(import);
        }
    }
}

/// The names under which the first part exports what the rest imports, in the order of the module.
struct Names {
    stubs: String,
    is_there: String,
    memories: Vec<String>,
    tables: Vec<String>,
    globals: Vec<String>,
    functions: Vec<(usize, String)>,
}

fn fill(module: &mut Module, table: TableId, offset: i32, functions: Vec<FunctionId>) {
    let offset = ConstExpr::Value(Value::I32(offset));
    let segment = module
        .elements
        .add(ElementKind::Active { table, offset }, ElementItems::Functions(functions));
    module.tables.get_mut(table).elem_segments.insert(segment);
}

fn ids(module: &Module) -> HashMap<usize, FunctionId> {
    module.funcs.iter().map(|function| (function.id().index(), function.id())).collect()
}

/// Returns the functions that can be called from outside of all functions.
fn roots(module: &Module) -> Result<Vec<usize>> {
    let mut roots: Vec<usize> = Vec::new();
    roots.extend(module.start.map(|id| id.index()));
    roots.extend(module.exports.iter().filter_map(|export| match export.item {
        ExportItem::Function(id) => Some(id.index()),
        _ => None,
    }));
    for element in module.elements.iter() {
        match (&element.items, &element.kind) {
            (
                ElementItems::Functions(ids),
                ElementKind::Active { offset: ConstExpr::Value(Value::I32(_)), .. },
            ) => {
                for id in ids {
                    roots.push(id.index());
                }
            }
            (ElementItems::Expressions(_, items), _)
                if items.iter().all(|item| matches!(item, ConstExpr::RefNull(_))) => {}
            _ => bail!("a table is filled in a way that is not known here"),
        }
    }
    Ok(roots)
}

fn callees(function: &walrus::Function) -> Vec<usize> {
    struct Callees(Vec<usize>);
    impl Visitor<'_> for Callees {
        fn visit_function_id(&mut self, function: &FunctionId) {
            self.0.push(function.index());
        }
    }
    let mut callees = Callees(Vec::new());
    if let FunctionKind::Local(local) = &function.kind {
        dfs_in_order(&mut callees, local, local.entry_block());
    }
    callees.0
}

/// Returns a short name for each number.
fn short_name(mut number: usize) -> String {
    const DIGITS: &[u8; 62] = b"0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
    let mut name = String::new();
    loop {
        name.push(char::from(DIGITS[number % 62]));
        number /= 62;
        if number == 0 {
            return name;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use walrus::{GlobalId, MemoryId};

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
            body.i32_const(0)
                .load(self.memory, ir::LoadKind::I32 { atomic: false }, address)
                .drop();
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

    /// Returns what the rest imports, or the first part exports, as names and kinds.
    fn kinds(parts: &Module) -> [Vec<(String, &'static str)>; 2] {
        use walrus::ImportKind;
        let imports = parts.imports.iter().map(|import| {
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
        let exports = parts.exports.iter().map(|export| {
            let kind = match export.item {
                ExportItem::Function(_) => "function",
                ExportItem::Table(_) => "table",
                ExportItem::Memory(_) => "memory",
                ExportItem::Global(_) => "global",
                ExportItem::Tag(_) => "tag",
            };
            (export.name.clone(), kind)
        });
        [
            if parts.exports.iter().next().is_some() { Vec::new() } else { imports.collect() },
            exports.collect(),
        ]
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
        let [imports, _] = kinds(&rest);
        let count = |kind: &str| imports.iter().filter(|(_, other)| *other == kind).count();
        assert_eq!(["function", "memory", "table", "global"].map(count), [2, 1, 2, 2]);
        let [_, exports] = kinds(&first);
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
}
