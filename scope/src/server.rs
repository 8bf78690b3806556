//! The server: loopback only, for pages of its own origin.

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::{RawQuery, Request, State, WebSocketUpgrade};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use terminal::failure::Failure;
use tokio::net::TcpListener;

use crate::delivery::Delivery;
use crate::estimators::Estimators;
use crate::hub::Hub;
use crate::page;
use crate::recorder::Finished;
use crate::session::{LONGEST_MESSAGE, session};
use crate::token::random;

/// Interval in which the server looks whether it is to end.
const LOOK: Duration = Duration::from_millis(50);

/// The port that addresses of HTTP have without naming it.
const HTTP: u16 = 80;

/// A port of this machine.
pub(crate) struct Server {
    listener: std::net::TcpListener,
    address: SocketAddr,
}

#[derive(Clone)]
struct Shared {
    hub: Arc<Hub>,
    port: u16,
}

impl Server {
    /// Listens on this port of the loopback interface; 0 takes a free one.
    ///
    /// # Errors
    /// [`Failure::Input`] if the port cannot be had.
    pub(crate) fn bind(port: u16) -> Result<Self, Failure> {
        let failed = |error| {
            Failure::Input(format!(
                "--port {port}: {error}; give a free port, or 0 for any"
            ))
        };
        let listener = std::net::TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        Ok(Self { listener, address })
    }

    /// Address of the page.
    pub(crate) fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Serves pages until the hub stops.
    ///
    /// # Errors
    /// [`Failure::Check`] if the system refuses sockets or threads.
    pub(crate) fn serve(self, hub: &Arc<Hub>) -> Result<(), Failure> {
        let failed = |error: std::io::Error| Failure::Check(format!("server: {error}"));
        let shared = Shared {
            hub: Arc::clone(hub),
            port: self.address.port(),
        };
        let router = Router::new()
            .route("/", get(index))
            .route("/ws", get(socket))
            .route("/recording.csv", get(csv))
            .route("/recording.mcap", get(mcap))
            .layer(from_fn_with_state(shared.clone(), own_origin))
            .with_state(shared);
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(failed)?;
        runtime.block_on(async {
            let listener = TcpListener::from_std(self.listener).map_err(failed)?;
            let serving = axum::serve(listener, router);
            tokio::select! {
                served = async { serving.await } => served.map_err(failed),
                () = ended(hub) => Ok(()),
            }
        })
    }
}

async fn ended(hub: &Hub) {
    while !hub.stops() {
        tokio::time::sleep(LOOK).await;
    }
    // The last events leave.
    tokio::time::sleep(LOOK).await;
}

/// Refuses requests for another host, as after DNS rebinding, and from another origin.
async fn own_origin(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let hosts = hosts(shared.port);
    let headers = request.headers();
    let is_own = |value: &str| hosts.iter().any(|host| value == host);
    let host = text(headers, header::HOST);
    if !host.is_some_and(is_own) {
        return refuse(StatusCode::MISDIRECTED_REQUEST, "another host");
    }
    let origin = text(headers, header::ORIGIN);
    let origin = match headers.contains_key(header::ORIGIN) {
        true => origin
            .and_then(|origin| origin.strip_prefix("http://"))
            .is_some_and(is_own),
        // A browser names the origin of every socket.
        false => request.uri().path() != "/ws",
    };
    match origin {
        true => next.run(request).await,
        false => refuse(StatusCode::FORBIDDEN, "another origin"),
    }
}

/// The hosts of a page at this port. A browser leaves out that of HTTP.
fn hosts(port: u16) -> Vec<String> {
    let names = ["127.0.0.1", "localhost"];
    let bare = names
        .iter()
        .filter(|_| port == HTTP)
        .map(|it| (*it).to_owned());
    let with_port = names.iter().map(|name| format!("{name}:{port}"));
    with_port.chain(bare).collect()
}

fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name).and_then(|value| value.to_str().ok())
}

fn refuse(status: StatusCode, what: &'static str) -> Response {
    (status, what).into_response()
}

async fn index(State(shared): State<Shared>) -> Response {
    let Ok(nonce) = random() else {
        return refuse(StatusCode::INTERNAL_SERVER_ERROR, "no random numbers");
    };
    let mut response = Html(page::html(&shared.hub.token, &nonce)).into_response();
    let headers = response.headers_mut();
    let mut set = |name: header::HeaderName, value: &str| {
        if let Ok(value) = HeaderValue::from_str(value) {
            headers.insert(name, value);
        }
    };
    set(header::CONTENT_SECURITY_POLICY, &page::policy(&nonce));
    set(header::CACHE_CONTROL, "no-store");
    set(header::X_CONTENT_TYPE_OPTIONS, "nosniff");
    set(header::REFERRER_POLICY, "no-referrer");
    response
}

async fn socket(State(shared): State<Shared>, upgrade: WebSocketUpgrade) -> Response {
    upgrade
        .max_message_size(LONGEST_MESSAGE)
        .max_frame_size(LONGEST_MESSAGE)
        .on_upgrade(move |socket| session(socket, shared.hub))
}

async fn csv(State(shared): State<Shared>, RawQuery(query): RawQuery) -> Response {
    let make = |finished: Arc<Finished>| Ok(Body::from(finished.csv()?));
    download(shared, query, "text/csv", make).await
}

async fn mcap(State(shared): State<Shared>, RawQuery(query): RawQuery) -> Response {
    let make = |finished: Arc<Finished>| {
        let bytes = finished.mcap(&Estimators::names())?;
        // It has all rows, the CSV the longest run alone.
        let delivery = Delivery::new(bytes, move || finished.take());
        Ok(Body::from_stream(delivery))
    };
    download(shared, query, "application/octet-stream", make).await
}

/// A file of the latest recording, made on a thread of its own.
async fn download(
    shared: Shared,
    query: Option<String>,
    kind: &'static str,
    make: impl FnOnce(Arc<Finished>) -> Result<Body, String> + Send + 'static,
) -> Response {
    if query != Some(format!("token={}", shared.hub.token)) {
        return refuse(StatusCode::FORBIDDEN, "wrong token");
    }
    let Some(finished) = shared.hub.recording() else {
        return refuse(StatusCode::NOT_FOUND, "no recording");
    };
    let made = tokio::task::spawn_blocking(move || make(finished));
    match made.await {
        Ok(Ok(body)) => ([(header::CONTENT_TYPE, kind)], body).into_response(),
        Ok(Err(error)) => (StatusCode::CONFLICT, error).into_response(),
        Err(_) => refuse(StatusCode::INTERNAL_SERVER_ERROR, "the file cannot be made"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn browser_names_no_port_of_http() {
        let with_port = ["127.0.0.1:80", "localhost:80", "127.0.0.1", "localhost"];
        assert_eq!(hosts(80), with_port);
        assert_eq!(hosts(8080), ["127.0.0.1:8080", "localhost:8080"]);
    }
}
