//! The socket of one page.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::extract::ws::{Message, WebSocket};
use serde_json::{Value, json};
use tokio::sync::broadcast::error::RecvError;
use tokio::time::timeout;

use crate::hub::{Event, Hub};
use crate::order::Order;

/// Longest message of a page, bytes.
pub(crate) const LONGEST_MESSAGE: usize = 1024;
/// Messages that a page may send in a second. A page that drags the handle sends about 80.
const MOST_A_SECOND: u32 = 300;
/// Shortest interval of the messages that say that the page lives, in a flood too. A page sends one every 100 ms, and the
/// board ends a scene after half a second without one.
const ALIVE: Duration = Duration::from_millis(50);
/// Messages that are no orders after which a page is disconnected.
const MOST_GARBAGE: u32 = 100;
/// Longest time in which a page takes an event.
const PATIENCE: Duration = Duration::from_secs(10);

/// A page.
struct Page {
    socket: WebSocket,
    hub: Arc<Hub>,
    number: u64,
    /// Whether the page has shown the token.
    is_known: bool,
    /// Whether the page was told that it commands.
    told: bool,
    garbage: u32,
    rate: Rate,
}

/// The rate of the messages of a page.
struct Rate {
    /// Begin of a second, and messages since.
    second: (Instant, u32),
    /// When the latest message came that says that the page lives, and was admitted.
    alive: Option<Instant>,
}

impl Rate {
    const fn new(now: Instant) -> Self {
        Self {
            second: (now, 0),
            alive: None,
        }
    }

    /// Whether a message is followed that has this order, if it has one. A flood must not keep anybody from disarming the
    /// board, and ends no scene by a silence.
    fn admits(&mut self, order: Option<&Order>, now: Instant) -> bool {
        if now.saturating_duration_since(self.second.0) >= Duration::from_secs(1) {
            self.second = (now, 0);
        }
        self.second.1 += 1;
        let is_due = (self.alive).is_none_or(|at| now.saturating_duration_since(at) >= ALIVE);
        let is_admitted = match order {
            Some(Order::Disarm) => true,
            Some(Order::Alive) if is_due => true,
            _ => self.second.1 <= MOST_A_SECOND,
        };
        if is_admitted && order == Some(&Order::Alive) {
            self.alive = Some(now);
        }
        is_admitted
    }
}

/// Serves a page until it goes.
pub(crate) async fn session(socket: WebSocket, hub: Arc<Hub>) {
    // A page that is there misses no event.
    let mut events = hub.listen();
    let number = hub.enter();
    let mut page = Page {
        socket,
        number,
        is_known: false,
        told: false,
        garbage: 0,
        rate: Rate::new(Instant::now()),
        hub: Arc::clone(&hub),
    };
    let mut facts = hub.facts.clone();
    facts["type"] = "facts".into();
    if page.tell(&facts).await.is_continue() {
        loop {
            let next = tokio::select! {
                event = events.recv() => match event {
                    Ok(Event::Rows(bytes)) => page.send(Message::Binary(bytes)).await,
                    Ok(Event::Text(text)) => page.send(Message::Text(text)).await,
                    // The page finds what it lost by the numbers of the rows.
                    Err(RecvError::Lagged(_)) => ControlFlow::Continue(()),
                    Ok(Event::End) | Err(RecvError::Closed) => ControlFlow::Break(()),
                },
                message = page.socket.recv() => match message {
                    Some(Ok(message)) => page.take(message).await,
                    Some(Err(_)) | None => ControlFlow::Break(()),
                },
            };
            if next.is_break() {
                break;
            }
        }
    }
    hub.leave(number);
}

impl Page {
    async fn send(&mut self, message: Message) -> ControlFlow<()> {
        match timeout(PATIENCE, self.socket.send(message)).await {
            Ok(Ok(())) => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        }
    }

    async fn tell(&mut self, value: &Value) -> ControlFlow<()> {
        self.send(Message::Text(value.to_string().into())).await
    }

    async fn tell_role(&mut self, commands: bool, why: &str) -> ControlFlow<()> {
        self.told = commands;
        self.tell(
            &json!({ "type": "role", "commands": commands, "known": self.is_known, "why": why }),
        )
        .await
    }

    async fn take(&mut self, message: Message) -> ControlFlow<()> {
        let text = match message {
            Message::Text(text) => text,
            Message::Close(_) => return ControlFlow::Break(()),
            Message::Ping(_) | Message::Pong(_) => return ControlFlow::Continue(()),
            Message::Binary(_) => return self.garbage(),
        };
        let order = Order::parse(&text);
        if !self.rate.admits(order.as_ref().ok(), Instant::now()) {
            self.hub.counts.flooded.fetch_add(1, Ordering::Relaxed);
            return ControlFlow::Continue(());
        }
        let Ok(order) = order else {
            return self.garbage();
        };
        if let Order::Join { token } = &order {
            self.is_known = *token == self.hub.token;
            return match (self.is_known, self.is_known && self.hub.join(self.number)) {
                (false, _) => {
                    self.refuse("the token is of another server; load the page again")
                        .await
                }
                (true, false) => self.tell_role(false, "another page commands").await,
                (true, true) => self.tell_role(true, "").await,
            };
        }
        if !self.is_known {
            return self
                .refuse("without the page's token, a page can only watch")
                .await;
        }
        if !self.hub.commands(self.number) {
            // Every page says that it lives.
            return match order {
                Order::Alive if !self.told => ControlFlow::Continue(()),
                _ => self.refuse("another page commands").await,
            };
        }
        let hello = self.hub.hello();
        match order.check().and_then(|()| order.fits(hello.as_ref())) {
            Ok(()) => {
                self.hub.order(order);
                ControlFlow::Continue(())
            }
            Err(why) => {
                self.hub.counts.refused.fetch_add(1, Ordering::Relaxed);
                self.tell(&json!({ "type": "refused", "why": why })).await
            }
        }
    }

    async fn refuse(&mut self, why: &str) -> ControlFlow<()> {
        self.hub.counts.refused.fetch_add(1, Ordering::Relaxed);
        self.tell_role(false, why).await
    }

    fn garbage(&mut self) -> ControlFlow<()> {
        self.hub.counts.garbage.fetch_add(1, Ordering::Relaxed);
        self.garbage += 1;
        match self.garbage > MOST_GARBAGE {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flood of two seconds: without its keep-alives a board would end its scene.
    #[test]
    fn flood_keeps_neither_disarm_nor_keep_alives_back() {
        let begin = Instant::now();
        let mut rate = Rate::new(begin);
        let (mut hands, mut alive) = (0, Vec::new());
        for ms in 0..2000 {
            let now = begin + Duration::from_millis(ms);
            let mut admits = |order: &Order| rate.admits(Some(order), now);
            hands += u32::from(admits(&Order::Hand { at: None }));
            if admits(&Order::Alive) && alive.last().is_none_or(|last| ms - last >= 50) {
                alive.push(ms);
            }
            assert!(admits(&Order::Disarm));
        }
        assert!(hands <= 2 * MOST_A_SECOND);
        assert!(
            alive.windows(2).all(|pair| pair[1] - pair[0] <= 100),
            "{alive:?}"
        );
        assert!(alive.last().is_some_and(|last| *last > 1900));
        // A flood of keep-alives is one too.
        let late = begin + Duration::from_secs(9);
        let admitted = (0..2000)
            .filter(|_| rate.admits(Some(&Order::Alive), late))
            .count();
        assert_eq!(admitted, MOST_A_SECOND as usize);
    }
}
