//! The parts of a module of WebAssembly that are translated.

use std::collections::{BTreeMap, BTreeSet};

use wasmparser::{
    CompositeInnerType, Data, DataKind, ExternalKind, FuncType, FunctionBody, KnownCustom,
    Operator, Parser, Payload, RelocSectionReader, RelocationType, SubType, TypeRef, ValType,
};

use super::value::Kind;

/// A function of the module.
pub(super) struct Function<'a> {
    /// Name in C: that of the export behind `limpid_`, or its number.
    pub(super) name: String,
    pub(super) parameters: Vec<Kind>,
    pub(super) result: Option<Kind>,
    pub(super) body: FunctionBody<'a>,
}

/// A module without imports: functions and constants.
pub(super) struct Module<'a> {
    pub(super) functions: Vec<Function<'a>>,
    /// Names of exports with the index of their functions. Functions with the same instructions are one.
    pub(super) exports: BTreeMap<String, usize>,
    /// Address of the constants, and their bytes.
    pub(super) first_constant: u32,
    pub(super) constants: Vec<u8>,
    /// Offsets in the file of numbers that are addresses of constants.
    pub(super) addresses: BTreeSet<u64>,
    /// Functions that use the stack, or call one that does.
    with_stack: BTreeSet<usize>,
}

impl<'a> Module<'a> {
    /// Reads a module whose linker kept the relocations.
    pub(super) fn read(wasm: &'a [u8]) -> Result<Self, String> {
        let mut types = Vec::new();
        let mut of_functions = Vec::new();
        let mut bodies = Vec::new();
        let mut exports = BTreeMap::new();
        let mut data: Option<(u32, Vec<u8>)> = None;
        let (mut code, mut addresses) = (0, None);
        for payload in Parser::new(0).parse_all(wasm) {
            match payload.map_err(text)? {
                Payload::TypeSection(section) => {
                    for group in section {
                        for one in group.map_err(text)?.into_types() {
                            types.push(function_type(one)?);
                        }
                    }
                }
                Payload::ImportSection(section) => {
                    for import in section.into_imports() {
                        let import = import.map_err(text)?;
                        if matches!(import.ty, TypeRef::Func(_)) {
                            return Err(format!("calls {}, which is not in it", import.name));
                        }
                    }
                }
                Payload::FunctionSection(section) => {
                    for index in section {
                        of_functions.push(index.map_err(text)?);
                    }
                }
                Payload::ExportSection(section) => {
                    for export in section {
                        let export = export.map_err(text)?;
                        if export.kind == ExternalKind::Func {
                            exports.insert(export.name.to_owned(), export.index as usize);
                        }
                    }
                }
                Payload::DataSection(section) => {
                    for segment in section {
                        let constants = constants(&segment.map_err(text)?)?;
                        if data.replace(constants).is_some() {
                            return Err("has several segments of data".to_owned());
                        }
                    }
                }
                Payload::CodeSectionStart {
                    unchecked_range, ..
                } => code = unchecked_range.start,
                Payload::CodeSectionEntry(body) => bodies.push(body),
                Payload::CustomSection(section) => {
                    if let KnownCustom::Reloc(relocations) = section.as_known()
                        && section.name() == "reloc.CODE"
                    {
                        addresses = Some(addresses_of(&relocations, code)?);
                    }
                }
                _ => {}
            }
        }
        let mut functions = Vec::new();
        for (k, (index, body)) in of_functions.into_iter().zip(bodies).enumerate() {
            let of: &FuncType = &types[index as usize];
            let kinds = |types: &[ValType]| -> Result<Vec<_>, String> {
                types.iter().map(|one| Kind::of(*one)).collect()
            };
            functions.push(Function {
                name: name(k, &exports),
                parameters: kinds(of.params())?,
                result: kinds(of.results())?.first().copied(),
                body,
            });
        }
        let (first_constant, constants) = data.unwrap_or_default();
        let addresses = match addresses {
            None if !constants.is_empty() => return Err("has no relocations".to_owned()),
            addresses => addresses.unwrap_or_default(),
        };
        let mut module = Self {
            functions,
            exports,
            first_constant,
            constants,
            addresses,
            with_stack: BTreeSet::new(),
        };
        module.find_stack()?;
        Ok(module)
    }

    /// Finds the functions that use the stack, or call one that does.
    fn find_stack(&mut self) -> Result<(), String> {
        let mut calls = BTreeMap::new();
        for (k, function) in self.functions.iter().enumerate() {
            let mut called = BTreeSet::new();
            for operator in function.body.get_operators_reader().map_err(text)? {
                match operator.map_err(text)? {
                    Operator::GlobalGet { .. } | Operator::GlobalSet { .. } => {
                        self.with_stack.insert(k);
                    }
                    Operator::Call { function_index } => {
                        called.insert(function_index as usize);
                    }
                    _ => {}
                }
            }
            calls.insert(k, called);
        }
        loop {
            let known = self.with_stack.len();
            for (k, called) in &calls {
                if !called.is_disjoint(&self.with_stack) {
                    self.with_stack.insert(*k);
                }
            }
            if self.with_stack.len() == known {
                return Ok(());
            }
        }
    }

    /// Whether a function uses the stack, or calls one that does.
    pub(super) fn uses_stack(&self, function: &Function) -> bool {
        let is_it = |k: &usize| self.functions[*k].name == function.name;
        self.with_stack.iter().any(is_it)
    }
}

/// The type of a function.
fn function_type(one: SubType) -> Result<FuncType, String> {
    match one.composite_type.inner {
        CompositeInnerType::Func(function) => Ok(function),
        _ => Err("has a type that is no function".to_owned()),
    }
}

/// Name in C of the function of index `k`.
fn name(k: usize, exports: &BTreeMap<String, usize>) -> String {
    let exported = exports.iter().find(|(_, index)| **index == k);
    exported.map_or_else(
        || format!("function_{k}"),
        |(name, _)| name.trim_start_matches("limpid_").to_owned(),
    )
}

/// The address and the bytes of a segment of data.
fn constants(segment: &Data<'_>) -> Result<(u32, Vec<u8>), String> {
    let DataKind::Active { offset_expr, .. } = &segment.kind else {
        return Err("has data without an address".to_owned());
    };
    let mut operators = offset_expr.get_operators_reader();
    let Operator::I32Const { value } = operators.read().map_err(text)? else {
        return Err("has data at an unknown address".to_owned());
    };
    Ok((value as u32, segment.data.to_vec()))
}

/// Offsets in the file of the numbers that are addresses of constants. The code begins at `code`.
fn addresses_of(relocations: &RelocSectionReader<'_>, code: u64) -> Result<BTreeSet<u64>, String> {
    let mut found = BTreeSet::new();
    for entry in relocations.entries() {
        let entry = entry.map_err(text)?;
        match entry.ty {
            RelocationType::MemoryAddrLeb | RelocationType::MemoryAddrSleb => {
                found.insert(code + u64::from(entry.offset));
            }
            RelocationType::FunctionIndexLeb
            | RelocationType::GlobalIndexLeb
            | RelocationType::TypeIndexLeb => {}
            other => return Err(format!("has a relocation {other:?}")),
        }
    }
    Ok(found)
}

/// An error as text.
pub(super) fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}
