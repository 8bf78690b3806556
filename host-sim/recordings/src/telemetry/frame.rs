use std::str::FromStr;

use super::beside::Beside;

/// How the line of a frame begins.
pub(super) const START: &str = "frame seq=";

/// The number of no estimator.
pub const NOBODY: u8 = u8::MAX;

/// What the firmware says of one control tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Sequence number.
    pub seq: u32,
    /// Control tick.
    pub tick: u32,
    /// Large encoder.
    pub large: u32,
    /// Small encoder.
    pub small: u32,
    /// Velocity of the large motor, rad/s.
    pub wl: f32,
    /// Velocity of the handle, rad/s.
    pub ws: f32,
    /// Standard deviation of `wl` that its estimator believes in, rad/s.
    pub sl: Option<f32>,
    /// Number of that estimator; [`NOBODY`] while one takes over, and where the scene needs none.
    pub estimator: Option<u8>,
    /// Torque that the handle should feel, N.m.
    pub torque: f32,
    /// Current of the large motor, A.
    pub il: f32,
    /// Current of the small motor, A.
    pub is: f32,
    /// State of the safety machine.
    pub state: String,
    /// Why it stopped.
    pub cause: String,
    /// Ticks missed or late.
    pub overruns: u32,
    /// Frames lost.
    pub drops: u32,
    /// Cycles of the control task.
    pub cycles: u32,
    /// What was said beside it.
    pub beside: Beside,
}

impl FromStr for Frame {
    type Err = String;

    /// By names, in any order; names that are not known, and what a log puts behind, are skipped.
    fn from_str(line: &str) -> Result<Self, String> {
        let fields = Fields(line);
        Ok(Self {
            seq: fields.number("seq")?,
            tick: fields.number("tick")?,
            large: fields.number("large")?,
            small: fields.number("small")?,
            wl: fields.number("wl")?,
            ws: fields.number("ws")?,
            sl: fields.optional("sl")?,
            estimator: fields.optional("estimator")?,
            torque: fields.number("torque")?,
            il: fields.number("il")?,
            is: fields.number("is")?,
            state: fields.text("state")?.to_owned(),
            cause: fields.text("cause")?.to_owned(),
            overruns: fields.number("overruns")?,
            drops: fields.number("drops")?,
            cycles: fields.number("cycles")?,
            beside: Beside::default(),
        })
    }
}

/// Words `name=value` of a line.
pub(super) struct Fields<'a>(pub(super) &'a str);

impl<'a> Fields<'a> {
    fn text(&self, name: &str) -> Result<&'a str, String> {
        let value = |word: &'a str| word.strip_prefix(name)?.strip_prefix('=');
        let found = self.0.split_whitespace().find_map(value);
        found.ok_or_else(|| format!("no {name} in '{}'", self.0))
    }

    /// What older images do not say.
    fn optional<T: FromStr>(&self, name: &str) -> Result<Option<T>, String> {
        match self.text(name) {
            Ok(_) => self.number(name).map(Some),
            Err(_) => Ok(None),
        }
    }

    pub(super) fn number<T: FromStr>(&self, name: &str) -> Result<T, String> {
        let value = self.text(name)?;
        let number = value.parse();
        number.map_err(|_| format!("'{name}={value}' is no number in '{}'", self.0))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) const LINE: &str = "frame seq=3 tick=30 large=65535 small=7 wl=-1.5 \
        ws=0.25 torque=0.0 il=0.1 is=-0.2 state=Running cause=None overruns=0 drops=1 cycles=900";

    #[test]
    fn a_frame_is_read_by_names() {
        let frame: Frame = LINE.parse().unwrap();
        assert_eq!((frame.tick, frame.large, frame.drops), (30, 65535, 1));
        assert_eq!((frame.wl, frame.state.as_str()), (-1.5, "Running"));
        assert_eq!((frame.sl, frame.estimator), (None, None));
        let said = LINE.replace("torque", "sl=0.5 estimator=255 torque");
        let said: Frame = said.parse().unwrap();
        assert_eq!((said.sl, said.estimator), (Some(0.5), Some(NOBODY)));
        assert!(
            LINE.replace("torque", "sl=x torque")
                .parse::<Frame>()
                .is_err()
        );
        let longer = LINE.replace(" ws", " new=1 ws") + " (firmware src/telemetry.rs:93)";
        assert_eq!(longer.parse(), Ok(frame));
    }

    #[test]
    fn a_frame_that_lacks_something_is_refused_with_a_reason() {
        let without = LINE.replace("drops=1 ", "");
        assert!(without.parse::<Frame>().unwrap_err().contains("no drops"));
        let wrong = LINE.replace("wl=-1.5", "wl=x");
        assert!(wrong.parse::<Frame>().unwrap_err().contains("'wl=x'"));
        for cut in 0..LINE.len() - 11 {
            assert!(LINE[..cut].parse::<Frame>().is_err(), "{}", &LINE[..cut]);
        }
    }
}
