//! What the source and the pages share: the stream to the pages, their orders, and who commands.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::Utf8Bytes;
use drivers::link::Hello;
use serde_json::{Value, json};
use terminal::failure::Failure;
use tokio::sync::broadcast;

use crate::estimators::Estimators;
use crate::order::Order;
use crate::recorder::Finished;

/// Events that wait for a page at most. A slower page loses the oldest ones: about a second.
const EVENTS: usize = 64;
/// Orders that wait for the source at most.
const ORDERS: usize = 64;
/// Silence after which another page may take the command.
pub(crate) const STALE: Duration = Duration::from_secs(2);

/// What goes to every page.
#[derive(Clone, Debug)]
pub(crate) enum Event {
    /// Rows, see [`Batch`](crate::batch::Batch).
    Rows(Bytes),
    /// A message in JSON.
    Text(Utf8Bytes),
    /// The source has ended: nothing follows.
    End,
}

/// Counts of what pages sent and the server did not follow.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    /// Messages that are no orders.
    pub(crate) garbage: AtomicU64,
    /// Orders of a page that may not command, or out of bounds.
    pub(crate) refused: AtomicU64,
    /// Messages beyond the rate of a page, and orders that found no room.
    pub(crate) flooded: AtomicU64,
}

impl Counts {
    fn json(&self) -> Value {
        let of = |count: &AtomicU64| count.load(Ordering::Relaxed);
        json!({
            "garbage": of(&self.garbage),
            "refused": of(&self.refused),
            "flooded": of(&self.flooded),
        })
    }
}

/// A page that commands, and when it was heard last.
#[derive(Clone, Copy, Debug)]
struct Commander {
    page: u64,
    heard: Instant,
}

impl Commander {
    /// Whether the page was not heard for too long.
    fn is_stale(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.heard) > STALE
    }
}

/// What the source and the pages share.
pub(crate) struct Hub {
    /// Random; a page that is served has it.
    pub(crate) token: String,
    /// What a page needs to know about the source, as JSON.
    pub(crate) facts: Value,
    pub(crate) counts: Counts,
    /// Set to end the source and the server.
    pub(crate) stop: AtomicBool,
    events: broadcast::Sender<Event>,
    orders: SyncSender<Order>,
    /// Latest order to the hand that the source has not taken.
    hand: Mutex<Option<Order>>,
    /// Whether the source has to disarm the board: the page that commanded has left, or its order to disarm
    /// found no room.
    left: AtomicBool,
    commander: Mutex<Option<Commander>>,
    recording: Mutex<Option<Arc<Finished>>>,
    /// Threads that write recordings which no page has taken and which have made room for the next one.
    rescues: Mutex<Vec<JoinHandle<Result<(), Failure>>>>,
    /// Identity of the image, once it has come.
    hello: Mutex<Option<Hello>>,
    /// Pages that have come.
    pages: AtomicU64,
    /// Pages that are there.
    present: AtomicU64,
}

/// A panic of another thread leaves these values whole.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Hub {
    /// A hub for a source with these facts, and the source's end of the orders.
    pub(crate) fn new(token: String, facts: Value) -> (Arc<Self>, Receiver<Order>) {
        let (orders, receiver) = sync_channel(ORDERS);
        let hub = Self {
            token,
            facts,
            counts: Counts::default(),
            stop: AtomicBool::new(false),
            events: broadcast::channel(EVENTS).0,
            orders,
            hand: Mutex::new(None),
            left: AtomicBool::new(false),
            commander: Mutex::new(None),
            recording: Mutex::new(None),
            rescues: Mutex::default(),
            hello: Mutex::new(None),
            pages: AtomicU64::new(0),
            present: AtomicU64::new(0),
        };
        (Arc::new(hub), receiver)
    }

    /// Sends an event to every page. Without a page it is gone.
    pub(crate) fn tell(&self, event: Event) {
        let _ = self.events.send(event);
    }

    /// Sends a message to every page, with the counts of what the server did not follow.
    pub(crate) fn status(&self, mut status: Value) {
        status["type"] = "status".into();
        status["counts"] = self.counts.json();
        status["commanded"] = locked(&self.commander).is_some().into();
        self.tell(Event::Text(status.to_string().into()));
    }

    /// The source has failed, and the server ends: tells every page why.
    pub(crate) fn ended(&self, failure: &Failure) {
        let ended = json!({ "type": "ended", "why": failure.to_string() });
        self.tell(Event::Text(ended.to_string().into()));
    }

    /// The events from now on.
    pub(crate) fn listen(&self) -> broadcast::Receiver<Event> {
        self.events.subscribe()
    }

    /// Number for a new page.
    pub(crate) fn enter(&self) -> u64 {
        self.present.fetch_add(1, Ordering::Relaxed);
        self.pages.fetch_add(1, Ordering::Relaxed)
    }

    /// Gives the command to a page, if no other page has it and was heard lately; whether the page has
    /// it.
    pub(crate) fn join(&self, page: u64) -> bool {
        let mut commander = locked(&self.commander);
        let is_free =
            commander.is_none_or(|other| other.page == page || other.is_stale(Instant::now()));
        if is_free {
            let heard = Instant::now();
            *commander = Some(Commander { page, heard });
        }
        is_free
    }

    /// Whether a page has the command; if so, it counts as heard.
    pub(crate) fn commands(&self, page: u64) -> bool {
        let mut commander = locked(&self.commander);
        match &mut *commander {
            Some(now) if now.page == page => {
                now.heard = Instant::now();
                true
            }
            _ => false,
        }
    }

    /// Takes an order of the page that commands.
    pub(crate) fn order(&self, order: Order) {
        if let Order::Hand { .. } = order {
            *locked(&self.hand) = Some(order);
            return;
        }
        let disarms = order == Order::Disarm;
        if self.orders.try_send(order).is_err() {
            self.counts.flooded.fetch_add(1, Ordering::Relaxed);
            if disarms {
                self.left.store(true, Ordering::Release);
            }
        }
    }

    /// The latest order to the hand, once.
    pub(crate) fn take_hand(&self) -> Option<Order> {
        locked(&self.hand).take()
    }

    /// The end of a page: one that commands lets go of the handle and disarms the board.
    pub(crate) fn leave(&self, page: u64) {
        self.present.fetch_sub(1, Ordering::Relaxed);
        if self.commands(page) {
            *locked(&self.commander) = None;
            self.order(Order::Hand { at: None });
            // No order: a full queue must not lose it.
            self.left.store(true, Ordering::Release);
        }
    }

    /// Whether the board has to be disarmed because the page that commanded has left, or found no room for
    /// its order; once. The orders from before it can be taken from then on, and come before the disarm.
    pub(crate) fn take_left(&self) -> bool {
        self.left.swap(false, Ordering::AcqRel)
    }

    /// Whether the page that commands was not heard for so long that its hand has to let go.
    pub(crate) fn is_abandoned(&self) -> bool {
        locked(&self.commander).is_none_or(|now| now.is_stale(Instant::now()))
    }

    /// Keeps a finished recording for downloads, instead of the one before. That one is written to files if no
    /// page has taken it, on a thread of its own: the source does not wait.
    pub(crate) fn keep(&self, finished: Arc<Finished>) {
        if let Some(before) = locked(&self.recording).replace(finished) {
            let rescue = move || before.rescue(&Estimators::names());
            locked(&self.rescues).push(thread::spawn(rescue));
        }
    }

    /// The server ends: recordings that no page has taken are in files then.
    ///
    /// # Errors
    /// [`Failure`] if one cannot be written.
    pub(crate) fn rescue(&self) -> Result<(), Failure> {
        let panicked = |_| {
            Err(Failure::Check(
                "a thread that writes a recording panicked".to_owned(),
            ))
        };
        let before = std::mem::take(&mut *locked(&self.rescues));
        let mut rescued = Ok(());
        for thread in before {
            rescued = rescued.and(thread.join().unwrap_or_else(panicked));
        }
        let last = self.recording();
        // Also after a failure.
        let last = last.map_or(Ok(()), |last| last.rescue(&Estimators::names()));
        rescued.and(last)
    }

    /// The latest finished recording.
    pub(crate) fn recording(&self) -> Option<Arc<Finished>> {
        locked(&self.recording).clone()
    }

    /// The board has told its identity, or has started again.
    pub(crate) fn identify(&self, hello: Option<Hello>) {
        *locked(&self.hello) = hello;
    }

    /// Identity of the image, once it has come.
    pub(crate) fn hello(&self) -> Option<Hello> {
        *locked(&self.hello)
    }

    /// Whether a page is there.
    pub(crate) fn is_seen(&self) -> bool {
        self.present.load(Ordering::Relaxed) > 0
    }

    /// Whether source and server are to end.
    pub(crate) fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hub() -> (Arc<Hub>, Receiver<Order>) {
        Hub::new("token".to_owned(), Value::Null)
    }

    #[test]
    fn page_that_does_not_read_loses_the_oldest_events() {
        let (hub, _orders) = hub();
        let mut events = hub.listen();
        for k in 0..3 * EVENTS {
            hub.tell(Event::Text(k.to_string().into()));
        }
        let lost = events.try_recv();
        assert!(
            matches!(lost, Err(broadcast::error::TryRecvError::Lagged(n)) if n == 2 * EVENTS as u64)
        );
        let Ok(Event::Text(next)) = events.try_recv() else {
            panic!("an event");
        };
        assert_eq!(next.as_str(), (2 * EVENTS).to_string());
    }

    #[test]
    fn page_that_was_not_heard_for_two_seconds_is_stale() {
        let heard = Instant::now();
        let commander = Commander { page: 1, heard };
        let two = Duration::from_secs(2);
        assert!(!commander.is_stale(heard) && !commander.is_stale(heard + two));
        assert!(commander.is_stale(heard + two + Duration::from_millis(1)));
    }

    #[test]
    fn page_that_is_not_heard_gives_the_command_to_the_next_one() {
        let (hub, _orders) = hub();
        let heard = |heard: Instant| *locked(&hub.commander) = Some(Commander { page: 1, heard });
        let now = Instant::now();
        let [stale, lately] = [now.checked_sub(2 * STALE), now.checked_add(60 * STALE)];
        assert!(hub.is_abandoned() && !hub.commands(1));
        heard(lately.expect("a time"));
        assert!(!hub.is_abandoned() && !hub.join(2));
        heard(stale.expect("a time"));
        assert!(hub.is_abandoned() && !hub.commands(2) && hub.commands(1));
        let latest = (*locked(&hub.commander)).map(|now| now.heard);
        assert!(latest >= Some(now), "each message counts");
        heard(stale.expect("a time"));
        assert!(hub.join(2) && !hub.commands(1));
    }

    #[test]
    fn orders_are_bounded_and_the_hand_has_its_latest_one() {
        let (hub, orders) = hub();
        for k in 0..3 * ORDERS {
            hub.order(Order::Alive);
            hub.order(Order::Hand { at: Some(k as f64) });
        }
        assert_eq!(orders.try_iter().count(), ORDERS);
        assert_eq!(
            hub.counts.flooded.load(Ordering::Relaxed),
            2 * ORDERS as u64
        );
        let last = (3 * ORDERS - 1) as f64;
        assert_eq!(hub.take_hand(), Some(Order::Hand { at: Some(last) }));
        assert_eq!(hub.take_hand(), None);
    }

    #[test]
    fn order_to_disarm_is_followed_with_a_full_queue_too() {
        let (hub, orders) = hub();
        hub.order(Order::Disarm);
        assert_eq!(orders.try_recv(), Ok(Order::Disarm));
        assert!(!hub.take_left());
        for _ in 0..ORDERS {
            hub.order(Order::Alive);
        }
        hub.order(Order::Disarm);
        assert!(hub.take_left() && !hub.take_left());
    }

    #[test]
    fn page_that_leaves_disarms_the_board_with_a_full_queue_too() {
        let (hub, _orders) = hub();
        for _ in 0..3 {
            hub.enter();
        }
        assert!(hub.join(1) && !hub.join(2));
        for _ in 0..2 * ORDERS {
            hub.order(Order::Alive);
        }
        hub.leave(2);
        assert!(!hub.take_left());
        hub.leave(1);
        assert!(hub.take_left() && !hub.take_left());
        assert_eq!(hub.take_hand(), Some(Order::Hand { at: None }));
        assert!(hub.join(2));
    }
}
