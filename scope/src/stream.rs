//! A file with every row from the begin of the server to its end.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};

use channels::McapWriter;
use terminal::failure::Failure;
use terminal::output::{note, write_with};
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;

use crate::batch;
use crate::estimators::Estimators;
use crate::hub::{Event, Hub};

/// A file in the making. It is complete when the server has ended, after Ctrl-C too.
pub(crate) struct Stream {
    path: PathBuf,
    thread: JoinHandle<Result<Written, Failure>>,
}

/// Rows of a file, and rows that came faster than they could be written.
#[derive(Clone, Copy, Debug, Default)]
struct Written {
    rows: u64,
    lost: u64,
}

/// Checks the name of the file.
///
/// # Errors
/// One line with what to do.
pub(crate) fn mcap_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path
        .extension()
        .is_some_and(|extension| extension == "mcap")
    {
        true => Ok(path),
        false => Err(
            "must end with .mcap; Record on the page and cargo drive record write CSV".to_owned(),
        ),
    }
}

impl Stream {
    /// Begins the file. If it cannot be written, the server ends.
    ///
    /// # Errors
    /// [`Failure::Check`] if there is no thread for it.
    pub(crate) fn start(path: PathBuf, hub: &Arc<Hub>) -> Result<Self, Failure> {
        let (mut events, hub, to) = (hub.listen(), Arc::clone(hub), path.clone());
        let named = thread::Builder::new().name("record".to_owned());
        let thread = named.spawn(move || {
            let mut written = Written::default();
            let ended = write_with(&to, |out| {
                written = write(out, &mut events).map_err(io::Error::other)?;
                Ok(())
            });
            if ended.is_err() {
                hub.stop.store(true, Ordering::Relaxed);
            }
            ended.map(|()| written)
        });
        let thread = thread.map_err(|error| Failure::Check(format!("a thread: {error}")))?;
        Ok(Self { path, thread })
    }

    /// Waits for the end of the file, which follows on [`Event::End`].
    ///
    /// # Errors
    /// [`Failure`] if the file could not be written.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        let panicked = || Err(Failure::Check("the recording panicked".to_owned()));
        let Written { rows, lost } = self.thread.join().unwrap_or_else(|_| panicked())?;
        let path = self.path.display();
        note(format_args!("{rows} rows in {path}, {lost} lost"));
        Ok(())
    }
}

/// Writes the rows of the events to their end.
fn write(out: &mut dyn Write, events: &mut Receiver<Event>) -> Result<Written, String> {
    let mut writer = McapWriter::new(out, &Estimators::names())?;
    let (mut written, mut next) = (Written::default(), None);
    loop {
        match events.blocking_recv() {
            Ok(Event::Rows(bytes)) => {
                let (first, rows) = batch::rows(&bytes);
                written.lost += next.map_or(0, |next| first - next);
                next = Some(first + rows.len() as u64);
                for row in &rows {
                    writer.row(row)?;
                }
                written.rows += rows.len() as u64;
            }
            Ok(Event::Text(_)) | Err(RecvError::Lagged(_)) => {}
            Ok(Event::End) | Err(RecvError::Closed) => break,
        }
    }
    writer.finish()?;
    Ok(written)
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::batch::Batch;

    #[test]
    fn file_has_all_rows_and_the_lost_ones_are_counted() {
        let (hub, _orders) = Hub::new("token".to_owned(), Value::Null);
        let mut events = hub.listen();
        let mut batch = Batch::new();
        let mut send = |rows: std::ops::Range<u32>, arrives: bool| {
            rows.for_each(|k| batch.add(&[f64::from(k), 2.0]));
            let bytes = batch.rest().expect("rows");
            if arrives {
                hub.tell(Event::Rows(bytes));
            }
        };
        send(0..5, true);
        send(5..7, false);
        send(7..10, true);
        hub.tell(Event::Text("{}".into()));
        hub.tell(Event::End);
        let mut bytes = Vec::new();
        let written = write(&mut bytes, &mut events).expect("a file");
        assert_eq!((written.rows, written.lost), (8, 2));
        let times: Vec<_> = mcap::MessageStream::new(&bytes)
            .expect("a file")
            .map(|message| message.expect("a message").log_time)
            .collect();
        assert_eq!(
            times,
            [0, 1, 2, 3, 4, 7, 8, 9].map(|s: u64| s * 1_000_000_000)
        );
    }

    #[test]
    fn other_names_are_refused() {
        assert!(mcap_file("run.mcap").is_ok());
        for name in ["run.csv", "run", "mcap"] {
            assert!(
                mcap_file(name).unwrap_err().contains("drive record"),
                "{name}"
            );
        }
    }
}
