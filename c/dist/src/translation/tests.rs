//! Statements of functions that are written by hand.

use super::body::Body;
use super::module::Module;

/// The statements of the first function of a module, and the declarations before them, line by line.
fn statements(functions: &str) -> Result<Vec<String>, String> {
    let wasm = wat::parse_str(format!("(module (memory 1) {functions})")).expect("a module");
    let module = Module::read(&wasm)?;
    let body = Body::translate(&module, &module.functions[0])?;
    Ok(body
        .text
        .lines()
        .map(|line| line.trim().to_owned())
        .collect())
}

/// The statements of a function with the parameters `l0` and `l1` and a result.
fn of(instructions: &str) -> Vec<String> {
    let function = format!("(func (param i32 i32) (result i32) {instructions})");
    statements(&function).expect("a translation")
}

#[test]
fn load_before_a_store_has_the_value_before_it() {
    let said = of("local.get 0 i32.load local.get 0 local.get 1 i32.store");
    assert_eq!(
        said,
        [
            "uint32_t t0;",
            "t0 = load_u32(l0);",
            "store_u32(l0, l1);",
            "return t0;"
        ]
    );
}

#[test]
fn local_that_is_read_before_it_is_set_has_the_value_before_it() {
    let said = of("local.get 0 local.get 1 local.set 0 local.get 0 i32.sub");
    assert_eq!(
        said,
        ["uint32_t t0;", "t0 = l0;", "l0 = l1;", "return (t0 - l0);"]
    );
}

#[test]
fn value_before_a_block_does_not_change_in_it() {
    let said =
        of("local.get 0 block local.get 1 br_if 0 i32.const 7 local.set 0 end local.get 1 i32.add");
    assert_eq!(
        said,
        [
            "uint32_t t0;",
            "t0 = l0;",
            "if (l1 != 0) goto label_0;",
            "l0 = UINT32_C(7);",
            "label_0:;",
            "return (t0 + l1);"
        ]
    );
}

#[test]
fn loop_is_left_at_its_end_and_begun_again_by_a_jump() {
    let said = of("loop local.get 0 i32.const 1 i32.sub local.tee 0 br_if 0 end local.get 0");
    assert_eq!(
        said,
        [
            "(void)l1;",
            "label_0:;",
            "l0 = (l0 - UINT32_C(1));",
            "if (l0 != 0) goto label_0;",
            "return l0;"
        ]
    );
}

#[test]
fn code_behind_a_jump_is_left_out_and_values_before_its_block_stay() {
    let said = of("local.get 0 block br 0 i32.const 7 local.set 0 end local.get 1 i32.add");
    assert_eq!(
        said,
        [
            "uint32_t t0;",
            "t0 = l0;",
            "goto label_0;",
            "label_0:;",
            "return (t0 + l1);"
        ]
    );
}

#[test]
fn condition_has_both_branches() {
    let said =
        of("local.get 0 if i32.const 1 local.set 1 else i32.const 2 local.set 1 end local.get 1");
    assert_eq!(
        said,
        [
            "if (l0 != 0) {",
            "l1 = UINT32_C(1);",
            "} else {",
            "l1 = UINT32_C(2);",
            "}",
            "return l1;"
        ]
    );
}

#[test]
fn load_before_a_call_has_the_value_before_it_and_an_unused_result_is_dropped() {
    let called = "(func (param i32) (result i32) local.get 0)";
    let said = statements(&format!(
        "(func (param i32) (result i32) local.get 0 f32.load local.get 0 call 1 drop i32.trunc_f32_s) {called}"
    ));
    assert_eq!(
        said.expect("a translation"),
        [
            "float t0;",
            "t0 = load_f32(l0);",
            "function_1(l0);",
            "return (uint32_t)(int32_t)t0;"
        ]
    );
}

#[test]
fn stack_is_a_parameter_and_its_frame_is_counted_with_those_below() {
    let stack = "(global (mut i32) (i32.const 65536))";
    let frame = |bytes: u32, call: &str| {
        format!(
            "(func global.get 0 i32.const {bytes} i32.sub global.set 0 {call} \
             global.get 0 i32.const {bytes} i32.add global.set 0)"
        )
    };
    let text = format!(
        "(module (memory 1) {stack} {} {})",
        frame(48, "call 1"),
        frame(16, "")
    );
    let wasm = wat::parse_str(text).expect("a module");
    let module = Module::read(&wasm).expect("a module");
    let bodies: Vec<_> = (module.functions.iter())
        .map(|function| Body::translate(&module, function).expect("a translation"))
        .collect();
    assert!(
        bodies[0].text.contains("function_1(stack);"),
        "{}",
        bodies[0].text
    );
    let depths = super::depths(&bodies);
    assert_eq!([depths[&0], depths[&1]], [64, 16]);
}

#[test]
fn signed_and_unsigned_numbers_are_told_apart() {
    for (instruction, expected) in [
        ("i32.lt_s", "return (uint32_t)((int32_t)l0 < (int32_t)l1);"),
        ("i32.lt_u", "return (uint32_t)(l0 < l1);"),
        ("i32.shr_s", "return (uint32_t)((int32_t)l0 >> (l1 & 31));"),
        ("i32.shr_u", "return (l0 >> (l1 & 31));"),
        ("i32.rem_s", "return (uint32_t)((int32_t)l0 % (int32_t)l1);"),
        ("i32.rem_u", "return (l0 % l1);"),
    ] {
        let said = of(&format!("local.get 0 local.get 1 {instruction}"));
        assert_eq!(said, [expected], "{instruction}");
    }
}

#[test]
fn what_has_no_translation_is_refused_by_name() {
    for (instructions, said) in [
        ("local.get 0 i32.popcnt", "I32Popcnt"),
        ("block (result i32) i32.const 1 end", "a block with a value"),
        ("f64.const 1 drop local.get 0", "F64Const"),
    ] {
        let function = format!("(func (param i32 i32) (result i32) {instructions})");
        let error = statements(&function).unwrap_err();
        assert!(error.contains(said), "{instructions}: {error}");
    }
    let foreign = wat::parse_str("(module (import \"env\" \"sinf\" (func)))").expect("a module");
    let error = Module::read(&foreign).err().expect("an error");
    assert_eq!(error, "calls sinf, which is not in it");
}
