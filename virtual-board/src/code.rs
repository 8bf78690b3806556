//! The functions of an ELF file, and their calls.

use std::collections::{BTreeMap, BTreeSet};

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

use crate::thumb::branches;

/// Functions by address.
#[derive(Clone, Debug, Default)]
pub struct Code(BTreeMap<u64, Vec<u8>>);

impl Code {
    /// The functions of a file.
    ///
    /// # Errors
    /// The errors of the ELF reader.
    pub fn of(file: &object::File<'_>) -> Result<Self, object::Error> {
        let mut functions = BTreeMap::new();
        for symbol in file.symbols() {
            let section = symbol
                .section_index()
                .and_then(|index| file.section_by_index(index).ok());
            let (SymbolKind::Text, Some(section)) = (symbol.kind(), section) else {
                continue;
            };
            let address = symbol.address() & !1;
            if let Some(bytes) = section.data_range(address, symbol.size())? {
                functions.insert(address, bytes.to_vec());
            }
        }
        Ok(Self(functions))
    }

    /// Bytes of the function at `address`.
    #[must_use]
    pub fn function(&self, address: u64) -> &[u8] {
        self.0.get(&address).map_or(&[], Vec::as_slice)
    }

    /// The function at `address` and all functions that it calls directly.
    #[must_use]
    pub fn reached(&self, address: u64) -> BTreeSet<u64> {
        let mut found = BTreeSet::new();
        let mut open = vec![address];
        while let Some(function) = open.pop() {
            if self.0.contains_key(&function) && found.insert(function) {
                let code = self.function(function);
                let end = function + code.len() as u64;
                let elsewhere = |target: &u64| !(function..end).contains(target);
                open.extend(branches(function, code).filter(elsewhere));
            }
        }
        found
    }
}

#[cfg(test)]
impl FromIterator<(u64, Vec<u8>)> for Code {
    fn from_iter<F: IntoIterator<Item = (u64, Vec<u8>)>>(functions: F) -> Self {
        Self(functions.into_iter().collect())
    }
}
