//! Instructions of WebAssembly, one by one.

use wasmparser::{MemArg, Operator};

use super::body::Translator;
use super::value::{Kind, Value, float};

/// The stack's top among the locals that a value reads.
pub(super) const STACK: u32 = u32::MAX;

impl Translator<'_> {
    /// `a OPERATOR b`.
    fn binary(&mut self, kind: Kind, operator: &str) -> Result<(), String> {
        self.binary_as(kind, |a, b| format!("({a} {operator} {b})"))
    }

    fn binary_as(
        &mut self,
        kind: Kind,
        write: impl Fn(&str, &str) -> String,
    ) -> Result<(), String> {
        let (b, a) = (self.pop()?, self.pop()?);
        let text = write(&a.number(), &b.number());
        self.push(Value::of(kind, text, &[&a, &b]));
        Ok(())
    }

    fn unary(&mut self, kind: Kind, write: impl Fn(&str) -> String) -> Result<(), String> {
        let a = self.pop()?;
        self.push(Value::of(kind, write(&a.number()), &[&a]));
        Ok(())
    }

    /// `(CAST)a OPERATOR (CAST)b`, a condition.
    fn compare(&mut self, cast: &str, operator: &str) -> Result<(), String> {
        let (b, a) = (self.pop()?, self.pop()?);
        let text = format!("({cast}{} {operator} {cast}{})", a.number(), b.number());
        self.push(Value::condition_of(text, &[&a, &b]));
        Ok(())
    }

    /// A division of signed numbers.
    fn signed(&mut self, kind: Kind, cast: &str, operator: &str) -> Result<(), String> {
        let c = kind.c();
        self.binary_as(kind, |a, b| {
            format!("({c})({cast}{a} {operator} {cast}{b})")
        })
    }

    fn is_zero(&mut self) -> Result<(), String> {
        let a = self.pop()?;
        let text = match a.is_condition {
            true => format!("!{}", a.text),
            false => format!("({} == 0)", a.text),
        };
        self.push(Value::condition_of(text, &[&a]));
        Ok(())
    }

    /// A shift by less than `width`.
    fn shift(&mut self, kind: Kind, cast: &str, operator: &str, width: u32) -> Result<(), String> {
        let c = kind.c();
        self.binary_as(kind, |a, b| match cast {
            "" => format!("({a} {operator} ({b} & {}))", width - 1),
            cast => format!("({c})({cast}{a} {operator} ({b} & {}))", width - 1),
        })
    }

    /// The address of an access to a number called `name`, and the name of its helper, which assumes no alignment where
    /// the access has less than 4 bytes of it.
    fn place(
        &mut self,
        name: &str,
        memory: &MemArg,
        address: bool,
    ) -> Result<(Value, String), String> {
        let base = self.pop()?;
        let mut text = base.number();
        if address {
            let offset = memory.offset - u64::from(self.module.first_constant);
            text = format!("{text} + ADDRESS(constants) + {offset}");
        } else if memory.offset > 0 {
            text = format!("{text} + {}", memory.offset);
        }
        let is_whole = ["u32", "u64", "f32"].contains(&name);
        let name = match is_whole && memory.align < 2 {
            true => format!("{name}_anywhere"),
            false => name.to_owned(),
        };
        Ok((Value::of(Kind::U32, text, &[&base]), name))
    }

    fn load(
        &mut self,
        kind: Kind,
        (helper, cast): (&str, &str),
        memory: &MemArg,
        address: bool,
    ) -> Result<(), String> {
        let (at, helper) = self.place(helper, memory, address)?;
        let mut value = Value::of(kind, format!("{cast}load_{helper}({})", at.text), &[&at]);
        value.loads = true;
        self.push(value);
        Ok(())
    }

    fn store(
        &mut self,
        name: &str,
        cast: &str,
        memory: &MemArg,
        address: bool,
    ) -> Result<(), String> {
        let value = self.pop()?;
        let (at, helper) = self.place(name, memory, address)?;
        self.keep(|value| value.loads);
        self.say(&format!(
            "store_{helper}({}, {cast}{});",
            at.text,
            value.number()
        ));
        Ok(())
    }

    /// Translates an instruction. `address` says that its number is the address of a constant.
    pub(super) fn take(&mut self, operator: &Operator, address: bool) -> Result<(), String> {
        use Kind::{F32, U32, U64};
        const SIGNED: &str = "(int32_t)";
        const SIGNED_64: &str = "(int64_t)";
        if self.is_passed_over(operator) {
            return Ok(());
        }
        match operator {
            Operator::Nop => Ok(()),
            Operator::Block { blockty } => {
                self.keep(|_| true);
                self.open(*blockty, false, false)
            }
            Operator::Loop { blockty } => {
                self.keep(|_| true);
                self.open(*blockty, true, false)
            }
            Operator::If { blockty } => {
                let condition = self.pop()?;
                self.keep(|_| true);
                self.say(&format!("if ({}) {{", condition.condition()));
                self.open(*blockty, false, true)
            }
            Operator::Else => {
                self.otherwise();
                Ok(())
            }
            Operator::End => self.close(),
            Operator::Br { relative_depth } => {
                let statement = self.jump(*relative_depth)?;
                self.say(&statement);
                self.unreachable = Some(0);
                Ok(())
            }
            Operator::BrIf { relative_depth } => {
                let condition = self.pop()?;
                let statement = self.jump(*relative_depth)?;
                self.say(&format!("if ({}) {statement}", condition.condition()));
                Ok(())
            }
            Operator::Return => {
                let statement = self.leave()?;
                self.say(&statement);
                self.unreachable = Some(0);
                Ok(())
            }
            Operator::Call { function_index } => self.call(*function_index as usize),
            Operator::Drop => self.pop().map(drop),
            Operator::Select => {
                let (condition, b, a) = (self.pop()?, self.pop()?, self.pop()?);
                let text = format!(
                    "({} ? {} : {})",
                    condition.condition(),
                    a.number(),
                    b.number()
                );
                self.push(Value::of(a.kind, text, &[&a, &b, &condition]));
                Ok(())
            }
            Operator::LocalGet { local_index } => {
                let kind = self.locals[*local_index as usize];
                self.stack.push(Value::local(kind, *local_index));
                Ok(())
            }
            Operator::LocalSet { local_index } => self.assign(*local_index),
            Operator::LocalTee { local_index } => {
                self.assign(*local_index)?;
                let kind = self.locals[*local_index as usize];
                self.stack.push(Value::local(kind, *local_index));
                Ok(())
            }
            Operator::GlobalGet { .. } => {
                let mut value = Value::local(U32, STACK);
                value.text = "stack".to_owned();
                self.stack.push(value);
                Ok(())
            }
            Operator::GlobalSet { .. } => self.assign(STACK),
            Operator::I32Const { value } => {
                let text = match address {
                    true => {
                        let offset = *value as u32 - self.module.first_constant;
                        format!("(ADDRESS(constants) + {offset})")
                    }
                    false => format!("UINT32_C({})", *value as u32),
                };
                self.stack.push(Value::new(U32, text));
                Ok(())
            }
            Operator::I64Const { value } => {
                let text = format!("UINT64_C({})", *value as u64);
                self.stack.push(Value::new(U64, text));
                Ok(())
            }
            Operator::F32Const { value } => {
                self.stack.push(Value::new(F32, float(value.bits())));
                Ok(())
            }
            Operator::I32Load { memarg } => self.load(U32, ("u32", ""), memarg, address),
            Operator::I64Load { memarg } => self.load(U64, ("u64", ""), memarg, address),
            Operator::F32Load { memarg } => self.load(F32, ("f32", ""), memarg, address),
            Operator::I32Load8U { memarg } => self.load(U32, ("u8", "(uint32_t)"), memarg, address),
            Operator::I32Load8S { memarg } => {
                self.load(U32, ("i8", "(uint32_t)(int32_t)"), memarg, address)
            }
            Operator::I32Load16U { memarg } => {
                self.load(U32, ("u16", "(uint32_t)"), memarg, address)
            }
            Operator::I32Load16S { memarg } => {
                self.load(U32, ("i16", "(uint32_t)(int32_t)"), memarg, address)
            }
            Operator::I64Load32U { memarg } => {
                self.load(U64, ("u32", "(uint64_t)"), memarg, address)
            }
            Operator::I64Load32S { memarg } => self.load(
                U64,
                ("u32", "(uint64_t)(int64_t)(int32_t)"),
                memarg,
                address,
            ),
            Operator::I32Store { memarg } => self.store("u32", "", memarg, address),
            Operator::I64Store { memarg } => self.store("u64", "", memarg, address),
            Operator::F32Store { memarg } => self.store("f32", "", memarg, address),
            Operator::I32Store8 { memarg } => self.store("u8", "(uint8_t)", memarg, address),
            Operator::I32Store16 { memarg } => self.store("u16", "(uint16_t)", memarg, address),
            Operator::I64Store32 { memarg } => self.store("u32", "(uint32_t)", memarg, address),
            Operator::I32Eqz | Operator::I64Eqz => self.is_zero(),
            Operator::I32Eq | Operator::I64Eq | Operator::F32Eq => self.compare("", "=="),
            Operator::I32Ne | Operator::I64Ne | Operator::F32Ne => self.compare("", "!="),
            Operator::I32LtU | Operator::I64LtU | Operator::F32Lt => self.compare("", "<"),
            Operator::I32GtU | Operator::I64GtU | Operator::F32Gt => self.compare("", ">"),
            Operator::I32LeU | Operator::I64LeU | Operator::F32Le => self.compare("", "<="),
            Operator::I32GeU | Operator::I64GeU | Operator::F32Ge => self.compare("", ">="),
            Operator::I32LtS => self.compare(SIGNED, "<"),
            Operator::I32GtS => self.compare(SIGNED, ">"),
            Operator::I32LeS => self.compare(SIGNED, "<="),
            Operator::I32GeS => self.compare(SIGNED, ">="),
            Operator::I64LtS => self.compare(SIGNED_64, "<"),
            Operator::I64GtS => self.compare(SIGNED_64, ">"),
            Operator::I64LeS => self.compare(SIGNED_64, "<="),
            Operator::I64GeS => self.compare(SIGNED_64, ">="),
            Operator::I32Add => {
                self.frame(operator);
                self.binary(U32, "+")
            }
            Operator::I32Sub => {
                self.frame(operator);
                self.binary(U32, "-")
            }
            Operator::I32Mul => self.binary(U32, "*"),
            Operator::I32DivU => self.binary(U32, "/"),
            Operator::I32RemU => self.binary(U32, "%"),
            Operator::I32DivS => self.signed(U32, SIGNED, "/"),
            Operator::I32RemS => self.signed(U32, SIGNED, "%"),
            Operator::I64DivS => self.signed(U64, SIGNED_64, "/"),
            Operator::I64RemS => self.signed(U64, SIGNED_64, "%"),
            Operator::I32And => self.binary(U32, "&"),
            Operator::I32Or => self.binary(U32, "|"),
            Operator::I32Xor => self.binary(U32, "^"),
            Operator::I32Shl => self.shift(U32, "", "<<", 32),
            Operator::I32ShrU => self.shift(U32, "", ">>", 32),
            Operator::I32ShrS => self.shift(U32, SIGNED, ">>", 32),
            Operator::I32Clz => self.unary(U32, |a| format!("leading_zeros({a})")),
            Operator::I64Add => self.binary(U64, "+"),
            Operator::I64Sub => self.binary(U64, "-"),
            Operator::I64Mul => self.binary(U64, "*"),
            Operator::I64And => self.binary(U64, "&"),
            Operator::I64Or => self.binary(U64, "|"),
            Operator::I64Xor => self.binary(U64, "^"),
            Operator::I64Shl => self.shift(U64, "", "<<", 64),
            Operator::I64ShrU => self.shift(U64, "", ">>", 64),
            Operator::I64ShrS => self.shift(U64, SIGNED_64, ">>", 64),
            Operator::I32WrapI64 => self.unary(U32, |a| format!("(uint32_t){a}")),
            Operator::I64ExtendI32U => self.unary(U64, |a| format!("(uint64_t){a}")),
            Operator::I64ExtendI32S => {
                self.unary(U64, |a| format!("(uint64_t)(int64_t)(int32_t){a}"))
            }
            Operator::F32Add => self.binary(F32, "+"),
            Operator::F32Sub => self.binary(F32, "-"),
            Operator::F32Mul => self.binary(F32, "*"),
            Operator::F32Div => self.binary(F32, "/"),
            Operator::F32Neg => self.unary(F32, |a| format!("(- {a})")),
            Operator::F32Abs => self.unary(F32, |a| format!("magnitude({a})")),
            Operator::F32Copysign => self.binary_as(F32, |a, b| format!("with_sign({a}, {b})")),
            Operator::F32ConvertI32S => self.unary(F32, |a| format!("(float)(int32_t){a}")),
            Operator::F32ConvertI32U => self.unary(F32, |a| format!("(float){a}")),
            Operator::F32ConvertI64S => self.unary(F32, |a| format!("(float)(int64_t){a}")),
            Operator::F32ConvertI64U => self.unary(F32, |a| format!("(float){a}")),
            Operator::I32TruncF32S => self.unary(U32, |a| format!("(uint32_t)(int32_t){a}")),
            Operator::I32TruncF32U => self.unary(U32, |a| format!("(uint32_t){a}")),
            Operator::I32ReinterpretF32 => self.unary(U32, |a| format!("bits({a})")),
            Operator::F32ReinterpretI32 => self.unary(F32, |a| format!("of_bits({a})")),
            other => Err(format!(
                "has the instruction {other:?}, which is not translated"
            )),
        }
    }

    /// Notes the bytes of stack that an instruction takes: the stack's top less a constant.
    fn frame(&mut self, operator: &Operator) {
        let [.., top, bytes] = self.stack.as_slice() else {
            return;
        };
        let number = bytes.text.strip_prefix("UINT32_C(");
        let number = number.and_then(|text| text.strip_suffix(')')?.parse::<u32>().ok());
        if let (true, "stack", Some(number)) = (
            matches!(operator, Operator::I32Sub),
            top.text.as_str(),
            number,
        ) {
            self.frame = self.frame.max(number);
        }
    }
}
