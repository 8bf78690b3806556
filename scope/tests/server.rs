//! The server against pages that err, flood, read slowly or vanish, with the flash image behind it.

mod common;

use common::{Client, Server, get, image, request};
use serde_json::{Value, json};

fn is_on(status: &Value) -> bool {
    status["on"] == true
}

/// A client that commands a board that runs scene `wall`, and lives.
fn running(server: &Server) -> Client {
    let mut client = server.joined();
    assert_eq!(client.role()["commands"], true);
    client.lives = true;
    client.status("the board sends frames", |status| status["mode"] == "boot");
    client.order(&json!({"do": "arm"}));
    client.status("armed", |status| status["mode"] == "armed");
    client.order(&json!({"do": "scene", "number": 2}));
    client.status("running", |status| {
        status["mode"] == "running" && status["scene"] == 2
    });
    client
}

#[test]
fn other_hosts_origins_and_tokens_are_refused() {
    let server = Server::emulated();
    let port = server.port;
    assert_eq!(get(port, "/", &[]).0, 200);
    assert_eq!(get(port, "/", &[("Host", "evil.example")]).0, 421);
    assert_eq!(get(port, "/", &[("Origin", "http://evil.example")]).0, 403);
    assert_eq!(get(port, "/recording.csv?token=00", &[]).0, 403);
    assert_eq!(
        get(port, &format!("/recording.csv?token={}", server.token), &[]).0,
        404
    );
    let other = format!("http://127.0.0.1:{}", port ^ 1);
    for origin in ["", "null", "http://evil.example", &other] {
        let refused = Client::connect(port, origin).err().expect("refused");
        assert!(refused.contains("403"), "{origin}: {refused}");
    }
    let policy = get(port, "/", &[]).1.to_lowercase();
    let policy = policy
        .lines()
        .find(|line| line.starts_with("content-security-policy"))
        .expect("a policy");
    assert!(
        policy.contains("default-src 'none'") && !policy.contains("unsafe"),
        "{policy}"
    );

    let mut watcher = server.client();
    watcher.order(&json!({"do": "arm"}));
    let role = watcher.role();
    assert!(
        role["known"] == false && role["why"].to_string().contains("token"),
        "{role}"
    );
    watcher.order(&json!({"do": "join", "token": "0".repeat(32)}));
    assert_eq!(watcher.role()["commands"], false);
    watcher.order(&json!({"do": "arm"}));
    let status = watcher.status("refusals are counted", |status| {
        status["counts"]["refused"] == 3
    });
    assert!(!is_on(&status));
    // It sees the board all the same.
    watcher.wait("rows", |watcher, _| (watcher.rows > 0).then_some(()));
}

#[test]
fn one_page_commands_and_the_other_watches_until_the_first_has_gone() {
    let server = Server::emulated();
    let mut first = running(&server);
    let mut second = server.client();
    // The connection may have taken longer than the silence after which another page may command.
    first.order(&json!({"do": "alive"}));
    second.order(&json!({"do": "join", "token": server.token}));
    assert_eq!(second.role()["commands"], false);
    first.live();
    second.order(&json!({"do": "disarm"}));
    assert!(
        second.role()["why"]
            .as_str()
            .is_some_and(|why| why.contains("another page"))
    );
    for _ in 0..20 {
        first.next();
    }
    assert!(is_on(&first.status("still running", |_| true)));
    // The page that commands goes away: the board is disarmed, and the other may command.
    drop(first);
    second.status("disarmed", |status| {
        status["mode"] == "boot" && status["commanded"] == false
    });
    second.order(&json!({"do": "join", "token": server.token}));
    assert_eq!(second.role()["commands"], true);
}

/// The controls of a page that was frozen would seem to work otherwise.
#[test]
fn page_that_froze_is_told_that_another_one_commands() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../tests/data/logs/missing-rows.csv"
    );
    let server = Server::start(&["--recording", path]);
    let mut frozen = server.joined();
    assert_eq!(frozen.role()["commands"], true);
    let mut other = server.joined();
    while other.role()["commands"] == false {
        other.status("some time", |_| true);
        other.order(&json!({"do": "join", "token": server.token}));
    }
    frozen.order(&json!({"do": "alive"}));
    assert_eq!(frozen.role()["commands"], false);
}

#[test]
fn device_goes_safe_when_keep_alives_stop() {
    let server = Server::emulated();
    let mut page = running(&server);
    page.lives = false;
    let status = page.status("the scene ends", |status| status["mode"] != "running");
    assert_eq!(status["cause"], "command-timeout");
    let status = page.status("the amplifiers are off", |status| !is_on(status));
    assert_eq!(status["cause"], "command-timeout");
}

#[test]
fn garbage_floods_and_slow_readers_do_not_affect_the_board() {
    let server = Server::emulated();
    let mut page = running(&server);
    // A page that never reads.
    let _slow = server.client();
    // A page that sends garbage until it is thrown out.
    let mut vandal = server.joined();
    for k in 0..2000 {
        page.live();
        let text = ["{", "\u{0}", "[[[[", "{\"tune\":{\"scene\":2}}"][k % 4];
        if vandal
            .socket
            .send(tungstenite::Message::text(text))
            .is_err()
        {
            break;
        }
    }
    vandal.wait_for_the_end(&mut page);
    let counts = page.status("garbage is counted", |status| {
        status["counts"]["garbage"].as_u64() > Some(100)
    });
    assert_eq!(counts["mode"], "running");
    // A message that is too long ends its page.
    let mut long = server.client();
    let _ = long
        .socket
        .send(tungstenite::Message::text("x".repeat(100_000)));
    long.wait_for_the_end(&mut page);
    // The page that commands floods: what is too much is not followed, and counted.
    for k in 0..5000 {
        page.live();
        page.order(&json!({"do": "hand", "at": 1e-4 * f64::from(k % 7)}));
    }
    let status = page.status("floods are counted", |status| {
        status["counts"]["flooded"].as_u64() > Some(1000)
    });
    assert_eq!(status["mode"], "running", "{status}");
    // A flood delays no order to disarm.
    page.order(&json!({"do": "disarm"}));
    let status = page.status("disarmed", |status| status["mode"] == "boot");
    assert_eq!(status["cause"], "none", "by the order, not by a silence");
    // Commands out of bounds are refused by the server, once the second of the flood is over.
    let why = page.wait("a refusal", |page, message| {
        page.order(&json!({"do": "tune", "scene": 2, "parameter": 1, "value": 100.0}));
        (message["type"] == "refused")
            .then(|| message["why"].as_str().unwrap_or_default().to_owned())
    });
    assert!(why.contains("out of bounds"), "{why}");
    // The board has lost no frame, and the page loses no row while it reads. It did not read while it
    // flooded, and may have lost some then.
    let (before, lost) = (page.rows, page.lost);
    page.wait("more rows", |page, _| {
        (page.rows > before + 500).then_some(())
    });
    assert_eq!((page.value("drops"), page.lost), (0.0, lost));
}

#[test]
fn fault_is_told_with_its_time_and_its_cause() {
    let server = Server::emulated();
    let mut page = running(&server);
    page.order(&json!({"do": "fault", "name": "emergency-stop"}));
    let status = page.status("a result", |status| status["fault"]["cause"].is_string());
    let fault = &status["fault"];
    assert_eq!(
        (&fault["name"], &fault["cause"]),
        (&json!("emergency-stop"), &json!("interlock"))
    );
    let off = fault["off_ms"].as_f64().expect("a time");
    assert!((0.0..5.0).contains(&off), "{off}");
    assert!(!is_on(
        &page.status("safe", |status| status["mode"] == "safe")
    ));
    page.status("no scene, so that one can be selected", |status| {
        status["scene"] == 0
    });
    // A new board is whole.
    page.order(&json!({"do": "restart"}));
    page.status("a new board", |status| status["mode"] == "boot");
    page.order(&json!({"do": "arm"}));
    page.status("armed", |status| status["mode"] == "armed");
}

#[test]
fn board_whose_core_is_halted_is_silent_until_a_new_one_starts() {
    let server = Server::emulated();
    let mut page = running(&server);
    page.order(&json!({"do": "fault", "name": "frozen-halt-timer-on"}));
    let status = page.status("a silence", |status| !status["silent"].is_null());
    assert!(
        status["silent"].to_string().contains("sends nothing"),
        "{status}"
    );
    page.order(&json!({"do": "scene", "number": 1}));
    let status = page.status("no command", |_| true);
    assert_eq!(status["scene"], 0);
    page.order(&json!({"do": "restart"}));
    let later = page.status("a new board", |status| {
        status["mode"] == "boot" && status["silent"].is_null()
    });
    // The time of a page goes on.
    assert!(later["t"].as_f64() > status["t"].as_f64(), "{later}");
}

#[test]
fn parameters_are_told_until_the_board_starts_anew() {
    let server = Server::emulated();
    let mut page = running(&server);
    let tune = |parameter, value: f64| json!({"do": "tune", "scene": 2, "parameter": parameter, "value": value});
    page.order(&tune(1, 0.25));
    let is_kept = |status: &Value| status["tuned"] == json!({"2.1": 0.25});
    page.status("a value", is_kept);
    // Another page has it too, and a value out of bounds changes nothing.
    page.order(&tune(1, 100.0));
    page.wait("a refusal", |_, message| {
        let why = message["why"].as_str().unwrap_or_default();
        (message["type"] == "refused" && why.contains("out of bounds")).then_some(())
    });
    server.client().status("the value", is_kept);
    page.order(&json!({"do": "disarm"}));
    page.status("disarmed", |status| {
        status["mode"] == "boot" && is_kept(status)
    });
    page.order(&json!({"do": "restart"}));
    page.status("the values after a start", |status| {
        status["tuned"] == json!({})
    });
}

#[test]
fn recording_that_a_page_has_taken_is_not_written_again() {
    let mut server = Server::emulated();
    let mut page = running(&server);
    page.order(&json!({"do": "record", "on": true}));
    page.status("a recording", |status| {
        status["recording"].as_u64() > Some(100)
    });
    page.order(&json!({"do": "record", "on": false}));
    page.status("its end", |status| status["recorded"] == true);
    let path = format!("/recording.mcap?token={}", server.token);
    assert_eq!(get(server.port, &path, &[]).0, 200);
    assert!(server.interrupt());
    let files = std::fs::read_dir(&server.folder).expect("a folder");
    assert_eq!(files.count(), 0);
}

#[test]
fn recordings_that_no_page_has_taken_are_written_each() {
    let mut server = Server::emulated();
    let mut page = running(&server);
    for frames in [100, 300] {
        page.order(&json!({"do": "record", "on": true}));
        page.status("a recording", |status| {
            status["recording"].as_u64() > Some(frames)
        });
        page.order(&json!({"do": "record", "on": false}));
        page.status("its end", |status| {
            status["recording"].is_null() && status["recorded"] == true
        });
        // The head of a file is no file, and the CSV has not all rows.
        let path = format!("/recording.mcap?token={}", server.token);
        assert_eq!(request("HEAD", server.port, &path, &[]).0, 200);
        let path = format!("/recording.csv?token={}", server.token);
        assert_eq!(get(server.port, &path, &[]).0, 200);
    }
    assert!(server.interrupt());
    let rows = [1, 2].map(|number| {
        let csv = server.folder.join(format!("scope-{number}.csv"));
        let recording = recordings::recording::Recording::read(&csv).expect("a recording");
        assert!(csv.with_extension("mcap").exists());
        recording.t.len()
    });
    assert!(rows[0] > 100 && rows[1] > 300, "{rows:?}");
}

#[test]
fn interrupt_ends_the_server_and_finishes_its_files() {
    let image = image();
    let image = image.to_str().expect("a path in UTF-8");
    let mut server = Server::start(&["--image", image, "--record", "all.mcap"]);
    let mut page = running(&server);
    page.order(&json!({"do": "record", "on": true}));
    page.status("a recording", |status| {
        status["recording"].as_u64() > Some(300)
    });
    assert!(server.interrupt());
    // Complete: with a summary, and all rows since the begin of the server.
    let messages = |name: &str, topic: &str| {
        let bytes = std::fs::read(server.folder.join(name)).expect("a file");
        let summary = mcap::Summary::read(&bytes).expect("a file");
        assert!(summary.is_some(), "{name} has no end");
        let messages = mcap::MessageStream::new(&bytes).expect("a file");
        let of_topic = messages.filter(|it| it.as_ref().expect("a message").channel.topic == topic);
        of_topic.count() as u64
    };
    assert!(
        messages("all.mcap", "/device") >= page.rows,
        "{}",
        page.rows
    );
    // The page cannot take its recording any more.
    let rows = messages("scope-1.mcap", "/device");
    assert!((300..page.rows).contains(&rows), "{rows}");
    let csv = server.folder.join("scope-1.csv");
    let recording = recordings::recording::Recording::read(&csv).expect("a recording");
    assert_eq!(recording.t.len() as u64, rows);
    let mut files: Vec<_> = std::fs::read_dir(&server.folder)
        .expect("a folder")
        .map(|file| file.expect("a file").file_name())
        .collect();
    files.sort();
    assert_eq!(files, ["all.mcap", "scope-1.csv", "scope-1.mcap"]);
}
