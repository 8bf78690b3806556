//! Tests of the control core, in one program because that is built sooner.

mod ammeters;
mod arming;
mod balance;
mod bench;
mod codes;
mod controller;
mod current_scale;
mod design;
mod excite;
mod fingerprint;
mod index;
mod margins;
mod monitor;
mod monitor_limits;
mod press;
mod safety;
mod safety_requests;
mod safety_times;
mod scenes;
mod stage;
mod supply;
mod switchboard;
mod tuning;
mod velocity_loop;
mod wind_up;
mod windings;
