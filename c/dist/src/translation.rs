//! `limpid.c`: the functions of the library as one file of C, for processors that the Rust toolchain has no target
//! for.
//!
//! The compiler translates the library to WebAssembly, and this module translates that to C, instruction by
//! instruction. A function of WebAssembly knows numbers of 32 and 64 bits and f32, whose arithmetic is that of
//! IEEE 754, and addresses of 32 bits: those of the processor, because the library has no memory of its own but
//! constants. Nothing of an estimator is written twice.

mod body;
mod instructions;
mod module;
#[cfg(test)]
mod tests;
mod value;

use std::collections::BTreeMap;
use std::fmt::Write as _;

use body::Body;
use module::{Function, Module};

/// First lines of the file: what the functions below use.
const PRELUDE: &str = include_str!("translation/prelude.c");

/// The text of `limpid.c`, of the library as `wasm` and of the header with its functions.
///
/// # Errors
/// One line if the library has something that has no translation.
pub(crate) fn translation(wasm: &[u8], header: &str) -> Result<String, String> {
    let module = Module::read(wasm).map_err(|error| format!("limpid.wasm: {error}"))?;
    let mut text = PRELUDE.replace("VERSION_OF_LIMPID", env!("CARGO_PKG_VERSION"));
    text += &constants(&module.constants);
    let mut bodies = Vec::new();
    for function in &module.functions {
        let body = Body::translate(&module, function)
            .map_err(|error| format!("limpid.wasm: {}: {error}", function.name))?;
        bodies.push(body);
    }
    for function in &module.functions {
        writeln!(text, "{};", head(&module, function)).expect("a string");
    }
    for (function, body) in module.functions.iter().zip(&bodies) {
        write!(text, "\n{}\n{{\n{}}}\n", head(&module, function), body.text).expect("a string");
    }
    let depths = depths(&bodies);
    for (name, index) in &module.exports {
        let function = &module.functions[*index];
        text += &exported(header, name, function, &bodies[*index], depths[index])?;
    }
    Ok(text)
}

/// The constants in memory, as words of the processor's order.
fn constants(bytes: &[u8]) -> String {
    let words = bytes.chunks(4).map(|chunk| {
        let mut word = [0; 4];
        word[..chunk.len()].copy_from_slice(chunk);
        u32::from_le_bytes(word)
    });
    let words: Vec<_> = words.map(|word| format!("UINT32_C({word})")).collect();
    let lines: Vec<_> = words
        .chunks(6)
        .map(|line| format!("    {},\n", line.join(", ")))
        .collect();
    format!(
        "static const uint32_t constants[] = {{\n{}}};\n\n",
        lines.concat()
    )
}

/// The declaration of a function; one that uses the stack has its top as the last parameter.
fn head(module: &Module, function: &Function) -> String {
    let mut parameters: Vec<_> = (0..)
        .zip(&function.parameters)
        .map(|(k, kind)| format!("{} l{k}", kind.c()))
        .collect();
    if module.uses_stack(function) {
        parameters.push("uint32_t stack".to_owned());
    }
    let result = function.result.map_or("void", value::Kind::c);
    format!(
        "static {result} {}({})",
        function.name,
        parameters.join(", ")
    )
}

/// Bytes of stack that each function needs with those that it calls.
fn depths(bodies: &[Body]) -> BTreeMap<usize, u32> {
    fn of(k: usize, bodies: &[Body], known: &mut BTreeMap<usize, u32>) -> u32 {
        if let Some(depth) = known.get(&k) {
            return *depth;
        }
        let calls = bodies[k].calls.iter();
        let below = calls.map(|call| of(*call, bodies, known)).max();
        let depth = bodies[k].frame + below.unwrap_or(0);
        known.insert(k, depth);
        depth
    }
    let mut known = BTreeMap::new();
    for k in 0..bodies.len() {
        of(k, bodies, &mut known);
    }
    known
}

/// A function of the header, which calls its translation.
fn exported(
    header: &str,
    name: &str,
    function: &Function,
    body: &Body,
    depth: u32,
) -> Result<String, String> {
    let missing = || format!("limpid.h has no function {name}");
    // The introduction shows calls.
    let (_, header) = header.split_once("extern \"C\"").ok_or_else(missing)?;
    let call = header.find(&format!(" {name}(")).ok_or_else(missing)?;
    let start = header[..call].rfind('\n').map_or(0, |end| end + 1);
    let length = header[start..].find(';').ok_or_else(missing)?;
    let prototype = &header[start..start + length];
    let (_, list) = prototype.split_once('(').ok_or_else(missing)?;
    let mut arguments = Vec::new();
    for parameter in list.trim_end_matches(')').split(',') {
        let name = parameter
            .rsplit([' ', '*', '\n'])
            .next()
            .ok_or_else(missing)?;
        arguments.push(match parameter.contains('*') {
            true => format!("ADDRESS({name})"),
            false => name.to_owned(),
        });
    }
    let words = depth.div_ceil(4);
    let stack = match body.uses_stack {
        true => {
            arguments.push(format!("ADDRESS(frame + {words})"));
            format!("    uint32_t frame[{words}];\n")
        }
        false => String::new(),
    };
    let result = if function.result.is_some() {
        "return "
    } else {
        ""
    };
    let arguments = arguments.join(", ");
    Ok(format!(
        "\n{prototype}\n{{\n{stack}    {result}{}({arguments});\n}}\n",
        function.name
    ))
}
