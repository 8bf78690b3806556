//! The flash image on an emulated STM32F427, in lockstep with the plant of `host-sim`.
//!
//! The timers' pins receive the quadrature edges at their times, the DAC and the enable lines drive
//! the amplifiers, the ADC reads their current monitors, and RTT is read and written as by a debug probe. The image runs unmodified. Cycles
//! are not modelled: a virtual second is a constant number of instructions.

pub mod adc;
mod amplifiers;
pub mod board;
pub mod bridge;
pub mod budget;
pub mod cli;
pub mod code;
pub mod command;
pub mod cycles;
pub mod dac;
pub mod fault;
pub mod fetch;
pub mod flash;
pub mod flow;
mod identity;
pub mod image;
mod lines;
pub mod live;
mod lockstep;
mod objections;
pub mod pieces;
pub mod pins;
pub mod port;
mod probe;
mod quadrature;
pub mod recording;
mod refused;
mod rtt;
pub mod run;
pub mod scene;
pub mod score;
mod stack;
mod summary;
pub mod thumb;
pub mod trace;
