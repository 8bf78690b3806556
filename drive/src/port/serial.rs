//! Serial ports, each for one program at a time.

#[cfg(unix)]
use std::fs::{File, TryLockError};
use std::io;
#[cfg(unix)]
use std::os::fd::AsFd as _;

use drivers::link::BAUD;
use serial2::{IntoSettings as _, KeepSettings, SerialPort};

use super::{READ, WRITE};

/// Opens and locks a serial port of this name.
///
/// # Errors
/// [`io::ErrorKind::ResourceBusy`] if another program has it.
pub(super) fn open(name: &str) -> io::Result<SerialPort> {
    // The settings and the input of a port that another program has stay as they are.
    let mut port = SerialPort::open(name, KeepSettings)?;
    #[cfg(unix)]
    lock(&port)?;
    let mut settings = port.get_configuration()?;
    BAUD.apply_to_settings(&mut settings)?;
    port.set_configuration(&settings)?;
    port.set_read_timeout(READ)?;
    port.set_write_timeout(WRITE)?;
    // What the board sent before has no meaning for this connection.
    port.discard_input_buffer()?;
    Ok(port)
}

/// Locks a serial port until it is closed. Unix gives a port to several programs at once, Windows to one.
///
/// # Errors
/// [`io::ErrorKind::ResourceBusy`] if another program has the lock.
#[cfg(unix)]
fn lock(port: &SerialPort) -> io::Result<()> {
    // The copy shares the lock of the port, so that its end leaves the port locked.
    let copy = File::from(port.as_fd().try_clone_to_owned()?);
    copy.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => io::ErrorKind::ResourceBusy.into(),
        TryLockError::Error(error) => error,
    })
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::os::fd::AsRawFd as _;

    use super::*;
    use crate::port::Port;

    #[test]
    fn serial_port_has_the_rate_of_the_link_and_one_program_at_a_time() {
        let (_board, device) = SerialPort::pair().unwrap();
        let link = format!("/proc/self/fd/{}", device.as_raw_fd());
        let name = std::fs::read_link(link).unwrap();
        let name = name.to_str().unwrap();
        let settings = open(name).unwrap().get_configuration().unwrap();
        assert_eq!(settings.get_baud_rate().unwrap(), BAUD);
        let first = Port::open(Some(name)).unwrap();
        let Err(error) = Port::open(Some(name)) else {
            panic!("two programs");
        };
        assert_eq!(error.status(), 2);
        let said = format!("{name}: another program has this port; end it first");
        assert_eq!(error.to_string(), said);
        drop(first);
        assert!(Port::open(Some(name)).is_ok());
    }
}
