//! The flash image, unmodified, on the virtual board in closed loop with the plant.

mod bridge;
mod choice;
mod cost;
mod current_monitor;
mod disturbed_line;
mod edges;
mod enables;
mod faults;
mod flash;
mod hardware;
mod healthy;
mod identify;
mod image;
mod index_pulse;
mod learned;
mod link;
mod mirror;
mod own_device;
mod record;
mod recording;
mod reference;
mod registers;
mod scores;
mod second_core;
mod settings;
mod size;
