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
    /// Begin of a second, and messages since.
    second: (Instant, u32),
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
        second: (Instant::now(), 0),
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
        if self.second.0.elapsed() >= Duration::from_secs(1) {
            self.second = (Instant::now(), 0);
        }
        self.second.1 += 1;
        let order = Order::parse(&text);
        // A flood must not keep anybody from disarming the board.
        if self.second.1 > MOST_A_SECOND && order != Ok(Order::Disarm) {
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
