//! Attempts to drive motors without the right to do so, on a real server with virtual motors.
#![cfg(test)]

#[path = "support/page.rs"]
mod page;
mod support;

use std::{
    io::Write,
    net::TcpStream,
    sync::Arc,
    time::{Duration, Instant},
};

use motorlink_bus::{Command, Consent};
use motorlink_messages::{Notice, ToWorker, encode};
use motorlink_protocol::{MotorId, Setpoint, SpeedTarget};
use motorlink_remote::{Stamp, ToServer, VIEWERS_MAX};
use motorlink_remote_server::{Pem, Tls, Token};
use page::{Page, start};
use support::{Bench, SOON, ask};
use tokio_rustls::rustls::{
    ClientConfig, ClientConnection, RootCertStore, StreamOwned,
    crypto::ring,
    pki_types::{CertificateDer, ServerName, pem::PemObject},
};
use tungstenite::{Message, client::IntoClientRequest, http::HeaderValue};

impl Bench {
    /// A page of this server, or what else says these headers.
    fn connect(&self, origin: &str, version: &str) -> Result<Page, tungstenite::Error> {
        let stream = TcpStream::connect(self.address)?;
        let token = self.token.as_ref().map(ToString::to_string);
        Page::connect(stream, origin, version, token.as_deref())
    }

    fn page(&self) -> Page {
        let origin = format!("http://{}", self.address);
        self.connect(&origin, "remote-boot.js").unwrap()
    }
}

impl Page {
    /// Whether the newest update says that a command was not carried out.
    fn is_refused(&self) -> bool {
        let update = self.update.as_ref();
        let notices = update.map_or(&[][..], |update| &update.notices);
        notices
            .iter()
            .any(|notice| matches!(notice, Notice::Refused { .. }))
    }

    fn closes(&mut self) -> bool {
        let until = Instant::now() + SOON;
        while Instant::now() < until {
            if !self.receive() {
                return true;
            }
        }
        false
    }

    fn stands(&self) -> bool {
        self.speed().is_some_and(|speed| speed.magnitude() == 0)
    }
}

#[test]
fn the_operator_drives_and_silence_stops_the_wheel() {
    let bench = Bench::start(None);
    let mut page = bench.page();
    page.take_control();
    page.drive();
    page.live(Duration::from_millis(1_500));
    assert!(page.turns(), "it drives for as long as it answers");
    page.answers = false;
    page.wait("a standing wheel", Page::stands);
    assert!(page.is_halted() && page.epoch.is_none());
    // It answers again, and does not drive again.
    page.answers = true;
    page.act(Command::Release);
    page.act(start());
    page.live(Duration::from_millis(600));
    assert!(page.stands() && page.is_halted());
}

#[test]
fn a_watcher_cannot_drive_and_can_stop() {
    let bench = Bench::start(None);
    let (mut operator, mut watcher) = (bench.page(), bench.page());
    watcher.wait("a challenge", |page| page.challenge != 0);
    watcher.act(start());
    watcher.live(Duration::from_millis(500));
    assert!(watcher.stands());
    operator.take_control();
    operator.drive();
    watcher.act(Command::StopAll(motorlink_bus::StopReason::Operator));
    operator.wait("a standing wheel", Page::stands);
    assert!(operator.is_halted());
}

/// The page's button Stop asks for zero in the motor's own loop.
#[test]
fn a_watcher_stops_a_motor_by_asking_for_zero() {
    let bench = Bench::start(None);
    let (mut operator, mut watcher) = (bench.page(), bench.page());
    operator.take_control();
    operator.drive();
    watcher.act(Command::Drive {
        id: MotorId::FIRST,
        setpoint: Setpoint::velocity(SpeedTarget::ZERO),
        consent: Consent::None,
    });
    operator.wait("a standing wheel", Page::stands);
    assert!(!operator.is_halted());
}

/// The driver refuses a start before Release. A page that only watches has not asked for it.
#[test]
fn a_refusal_is_told_to_the_page_that_asked() {
    let bench = Bench::start(None);
    let (mut operator, mut watcher) = (bench.page(), bench.page());
    operator.take_control();
    operator.act(Command::StopAll(motorlink_bus::StopReason::Operator));
    operator.wait("a halt", Page::is_halted);
    operator.act(start());
    operator.wait("a refusal", Page::is_refused);
    let until = Instant::now() + Duration::from_millis(500);
    while Instant::now() < until {
        watcher.receive();
        assert!(!watcher.is_refused());
    }
}

/// Questions and acts without the right to them do not fill the queue of the operator.
#[test]
fn a_page_that_asks_without_end_does_not_end_the_lease() {
    let bench = Bench::start(None);
    let mut operator = bench.page();
    operator.take_control();
    operator.drive();
    let mut asking = bench.page();
    let until = Instant::now() + Duration::from_secs(2);
    while Instant::now() < until {
        for _ in 0..8 {
            asking.act(start());
            asking.send(&ToServer::Take { by_force: false });
            operator.receive();
        }
        asking.receive();
    }
    assert!(operator.turns() && operator.epoch.is_some());
}

#[test]
fn an_act_that_is_sent_again_has_no_effect() {
    let bench = Bench::start(None);
    let mut page = bench.page();
    page.take_control();
    page.drive();
    let recorded = Stamp {
        epoch: page.epoch.unwrap(),
        sequence: page.sequence,
        challenge: page.challenge,
    };
    page.act(Command::Stop(MotorId::FIRST));
    page.wait("a standing wheel", Page::stands);
    for _ in 0..5 {
        page.act_with(recorded, start());
    }
    page.live(Duration::from_millis(600));
    assert!(page.stands());
}

#[test]
fn pages_of_other_sites_and_other_versions_are_refused() {
    let bench = Bench::start(None);
    for origin in ["http://evil.example", "null", "https://127.0.0.1:1"] {
        assert!(bench.connect(origin, "remote-boot.js").is_err(), "{origin}");
    }
    // A name that leads here, as after DNS rebinding.
    for path in ["/", "/motorlink"] {
        assert_eq!(bench.get(path, "Host: evil.example\r\n").0, 403);
        assert_eq!(bench.get(path, "").0, 403, "no name at all");
    }
    let own = format!("http://{}", bench.address);
    let mut old = bench.connect(&own, "remote-boot-old.js").unwrap();
    assert!(old.closes());
}

#[test]
fn nobody_enters_without_the_token() {
    let token = Token::new().unwrap();
    let bench = Bench::start(Some(token.clone()));
    let host = bench.host();
    assert_eq!(bench.get("/", &host).0, 401);
    assert_eq!(bench.get("/motorlink", &host).0, 401);
    let (status, answer) = bench.get(&format!("/?token={token}"), &host);
    assert_eq!(status, 303);
    assert!(
        answer.contains("HttpOnly") && answer.contains("location: /\r\n"),
        "{answer}"
    );
    let cookie = format!("{host}Cookie: motorlink-token={token}\r\n");
    assert_eq!(bench.get("/", &cookie).0, 200);
    bench.page().take_control();

    // 10,000 wrong ones: the first ten are compared, the others wait.
    let mut refused = [0, 0];
    for wrong in 0..10_000_u32 {
        let (status, _) = bench.get(&format!("/?token={wrong:032x}"), &host);
        match status {
            401 => refused[0] += 1,
            429 => refused[1] += 1,
            other => panic!("status {other}"),
        }
    }
    assert_eq!(refused, [10, 9_990]);
    // Who has the cookie is not locked out.
    assert_eq!(bench.get("/", &cookie).0, 200);
}

#[test]
fn garbage_and_messages_that_are_too_long_or_too_many_end_a_connection_and_disturb_nobody() {
    let bench = Bench::start(None);
    let mut operator = bench.page();
    operator.take_control();
    operator.drive();
    let mut garbage = bench.page();
    garbage
        .socket
        .send(Message::binary(vec![0xFF; 64]))
        .unwrap();
    assert!(garbage.closes());
    let mut text = bench.page();
    text.socket.send(Message::text("hello")).unwrap();
    assert!(text.closes());
    operator.live(Duration::from_millis(100));
    let mut long = bench.page();
    // The server may close before it has taken all of it.
    let _ = long.socket.send(Message::binary(vec![0; 2_000_000]));
    operator.live(Duration::from_millis(100));
    assert!(long.closes());
    let mut flood = bench.page();
    let answer = encode(&ToServer::Answer { challenge: 1 }).unwrap();
    for _ in 0..2_000 {
        if flood.socket.send(Message::binary(answer.clone())).is_err() {
            break;
        }
    }
    operator.live(Duration::from_millis(100));
    assert!(flood.closes());
    operator.live(Duration::from_millis(500));
    assert!(operator.turns() && operator.epoch.is_some());
}

#[test]
fn slow_heads_and_a_thousand_connections_leave_the_operator_alone() {
    let bench = Bench::start(None);
    let mut operator = bench.page();
    operator.take_control();
    operator.drive();
    let mut slow: Vec<TcpStream> = Vec::new();
    for _ in 0..1_000 {
        if let Ok(mut stream) = TcpStream::connect(bench.address) {
            // One too many is closed at once.
            let _ = stream.write_all(b"GET / HT");
            slow.push(stream);
        }
        operator.receive();
    }
    // The server lets go of those that do not finish.
    operator.live(Duration::from_millis(6_500));
    assert!(operator.turns() && operator.epoch.is_some());
    let until = Instant::now() + SOON;
    while bench.get("/", &bench.host()).0 != 200 {
        assert!(Instant::now() < until, "no page is served any more");
        operator.receive();
    }
}

#[test]
fn pages_are_limited() {
    let bench = Bench::start(None);
    let mut pages = Vec::new();
    while pages.len() < VIEWERS_MAX {
        pages.push(bench.page());
        // A page that sends nothing for ten seconds is closed. On a busy computer, so many pages take longer to connect.
        if pages.len() % 16 == 0 {
            for page in &mut pages {
                page.socket.send(Message::Ping(vec![].into())).unwrap();
            }
        }
    }
    assert!(pages[0].receive());
    let mut further = bench.page();
    assert!(further.closes());
}

#[test]
fn an_encrypted_server_answers_only_encrypted_requests() {
    let pem = Pem::make(vec!["127.0.0.1".to_owned()]).unwrap();
    let token = Token::new().unwrap();
    let bench = Bench::start_encrypted(
        Some(token.clone()),
        Some(Tls::new(&pem).unwrap()),
        |_, _| (),
    );
    let host = bench.host();
    assert_eq!(bench.get("/", &host).0, 0, "no answer to a plain request");

    let mut roots = RootCertStore::empty();
    let certificate = CertificateDer::from_pem_slice(pem.certificate.as_bytes()).unwrap();
    roots.add(certificate).unwrap();
    let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_root_certificates(roots)
        .with_no_client_auth();
    let config = Arc::new(config);
    let get = |path: &str, headers: &str| {
        let name = ServerName::from(bench.address.ip());
        let client = ClientConnection::new(Arc::clone(&config), name).unwrap();
        let stream = TcpStream::connect(bench.address).unwrap();
        ask(StreamOwned::new(client, stream), path, headers)
    };
    let (status, answer) = get(&format!("/?token={token}"), &host);
    assert!(status == 303 && answer.contains("; Secure"), "{answer}");
    let cookie = format!("{host}Cookie: __Host-motorlink-token={token}\r\n");
    assert_eq!(get("/", &cookie).0, 200);
    let upgrade = format!(
        "{cookie}Origin: https://{}\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n",
        bench.address
    );
    let upgrade = upgrade.replace("Origin", "Connection: Upgrade\r\nOrigin");
    assert_eq!(get("/motorlink?page=other", &upgrade).0, 101);
}

/// A program that plots sees the wheel that the operator drives, and cannot drive it.
#[test]
fn a_client_of_foxglove_watches_the_turning_wheel_and_cannot_stop_it() {
    let bench = Bench::start(None);
    let mut operator = bench.page();
    operator.take_control();
    operator.drive();
    let url = format!("ws://{}/foxglove", bench.address);
    let mut request = url.into_client_request().unwrap();
    let protocol = HeaderValue::from_static("foxglove.sdk.v1");
    request
        .headers_mut()
        .insert("Sec-WebSocket-Protocol", protocol);
    let (mut plot, _) = tungstenite::connect(request).unwrap();
    let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":257}]}"#;
    let stop = ToWorker::Command {
        command: Command::StopAll(motorlink_bus::StopReason::Operator),
        given_ms: 0.0,
    };
    let stop = ToServer::Act {
        stamp: Stamp {
            epoch: operator.epoch.unwrap(),
            sequence: operator.sequence + 1,
            challenge: operator.challenge,
        },
        age_ms: 0,
        message: encode(&stop).unwrap(),
    };
    plot.send(Message::text(subscribe)).unwrap();
    plot.send(Message::binary(encode(&stop).unwrap())).unwrap();
    let mut turning = 0;
    let until = Instant::now() + SOON;
    while turning < 20 {
        assert!(Instant::now() < until, "{turning} messages");
        operator.receive();
        if let Message::Binary(bytes) = plot.read().unwrap() {
            let text = String::from_utf8_lossy(&bytes[13..]).into_owned();
            assert!(text.contains(r#""setpoint":100,"#), "{text}");
            turning += 1;
        }
    }
    operator.live(Duration::from_millis(500));
    assert!(operator.turns() && operator.epoch.is_some());
}
