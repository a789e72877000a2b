//! Keeps only those types of a part that it uses.
//!
//! The splitter gives each part the types of the whole program: a kilobyte. Encoding the part again also shortens each index
//! in its code, for which the linker takes five bytes. Both together are 2 % of all parts.

use std::collections::BTreeMap;
use std::convert::Infallible;

use anyhow::{Result, anyhow};
use wasm_encoder::{
    Module, TypeSection,
    reencode::{Error, Reencode},
};
use wasmparser::{Parser, TypeSectionReader};

/// The part without the types that nothing in it names.
pub fn keep(wasm: &[u8]) -> Result<Vec<u8>> {
    let encoded = |types: &mut Types| -> Result<Vec<u8>> {
        let mut module = Module::new();
        types
            .parse_core_module(&mut module, Parser::new(0), wasm)
            .map_err(|error| anyhow!("the types of a part cannot be read: {error}"))?;
        Ok(module.finish())
    };
    let mut types = Types::default();
    encoded(&mut types)?;
    for (new, place) in (0..).zip(types.places.values_mut()) {
        *place = new;
    }
    encoded(&mut types)
}

/// The types that are used, with the place of each in the new file.
#[derive(Default)]
struct Types {
    places: BTreeMap<u32, u32>,
}

impl Reencode for Types {
    type Error = Infallible;

    fn type_index(&mut self, old: u32) -> Result<u32, Error<Infallible>> {
        Ok(*self.places.entry(old).or_insert(old))
    }

    fn parse_type_section(
        &mut self,
        types: &mut TypeSection,
        section: TypeSectionReader<'_>,
    ) -> Result<(), Error<Infallible>> {
        for (place, ty) in (0..).zip(section.into_iter_err_on_gc_types()) {
            if self.places.contains_key(&place) {
                let ty = self.func_type(ty?)?;
                types.ty().func_type(&ty);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use wasm_encoder::{
        BlockType, CodeSection, EntityType, Function, FunctionSection, ImportSection, Instruction,
        ValType,
    };

    use super::*;

    /// A part that uses these of its types: for an import, a function, a block, and a call by a table.
    fn part(all: &[&[ValType]], [import, function, block, call]: [u32; 4]) -> Vec<u8> {
        let mut types = TypeSection::new();
        for parameters in all {
            types.ty().function(parameters.iter().copied(), []);
        }
        let mut imports = ImportSection::new();
        imports.import("main", "f", EntityType::Function(import));
        let mut functions = FunctionSection::new();
        functions.function(function);
        let mut body = Function::new([]);
        body.instruction(&Instruction::Block(BlockType::FunctionType(block)));
        body.instruction(&Instruction::End);
        body.instruction(&Instruction::I32Const(0));
        body.instruction(&Instruction::CallIndirect {
            type_index: call,
            table_index: 0,
        });
        body.instruction(&Instruction::End);
        let mut code = CodeSection::new();
        code.function(&body);
        let mut module = Module::new();
        module.section(&types).section(&imports);
        module.section(&functions).section(&code);
        module.finish()
    }

    #[test]
    fn only_the_types_that_are_used_stay_and_keep_their_meaning() {
        let [a, b, c, d] = [
            [ValType::I32].as_slice(),
            &[ValType::I64],
            &[ValType::F32],
            &[ValType::F64],
        ];
        let unused = &[ValType::I32, ValType::I32];
        let kept = keep(&part(&[unused, a, b, unused, c, d], [4, 1, 5, 2])).unwrap();
        assert_eq!(kept, part(&[a, b, c, d], [2, 0, 3, 1]));
        assert_eq!(keep(&kept).unwrap(), kept);
    }
}
