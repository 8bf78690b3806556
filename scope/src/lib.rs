//! The device live in a browser: a source behind a server at the loopback interface, and one page.

mod batch;
mod bench;
pub mod cli;
mod delivery;
mod desk;
mod estimators;
mod facts;
mod fault_watch;
mod guide;
mod hub;
mod order;
mod page;
mod parameters;
mod recorder;
mod refusals;
mod selection;
mod server;
mod session;
mod source;
mod storing;
mod stream;
mod tactile;
mod token;
mod undo;
mod values;
