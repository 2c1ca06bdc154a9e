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
    GlobalKind, ImportedFunction, LocalId, Module, ModuleConfig, RefType, TableId, ValType, passes,
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

/// The division of a module. Functions are identified by their index: parsing the same bytes again
/// gives each function the same one.
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
            let mut body = stub.func_body();
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
            ) => roots.extend(ids.iter().map(FunctionId::index)),
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
mod tests;
