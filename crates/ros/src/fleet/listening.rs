//! The Zenoh session of `motorlink-fleet`, which listens to all robots.

use std::{
    sync::{Arc, Mutex, OnceLock, PoisonError},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Result, anyhow};
use zenoh::{Config, Session, Wait as _, sample::SampleKind};

use super::{
    names::{ALL_STATES, ALL_TOKENS},
    watch::{Row, Watch},
};
use crate::{arguments::Network, say};

/// How often a router that is not there is tried.
const RETRY: Duration = Duration::from_secs(1);

/// What is known now.
#[derive(Debug)]
pub struct View {
    /// Problems first.
    pub rows: Vec<Row>,
    /// Messages that were no valid state.
    pub ignored: u64,
    /// The session has a router.
    pub has_router: bool,
}

/// Listens to all robots.
#[derive(Clone, Debug, Default)]
pub struct Listening {
    watch: Arc<Mutex<Watch>>,
    session: Arc<OnceLock<Session>>,
}

/// A client: a peer would connect to each robot that it hears of. No robot sends a message that is larger than this.
///
/// # Errors
///
/// For a file that is no configuration, and an endpoint that is none.
pub fn client(network: &Network) -> Result<Config> {
    network.configuration(&[
        ("mode", "\"client\""),
        ("transport/link/rx/max_message_size", "4194304"),
    ])
}

impl Listening {
    /// Listens as soon as there is a router, and again after it was gone. `says`: on the standard error, too, if there is none.
    #[must_use]
    pub fn start(config: Config, says: bool) -> Self {
        let listening = Self::default();
        let opening = listening.clone();
        thread::spawn(move || {
            let mut is_first = says;
            while let Err(error) = opening.open(config.clone()) {
                if std::mem::take(&mut is_first) {
                    say(&format!("{error:#}. Trying again"));
                }
                thread::sleep(RETRY);
            }
        });
        listening
    }

    fn open(&self, config: Config) -> Result<()> {
        let session = open(config)?;
        let watch = Arc::clone(&self.watch);
        let states = session
            .declare_subscriber(ALL_STATES)
            .callback(move |sample| {
                let (key, bytes) = (sample.key_expr().as_str(), sample.payload().to_bytes());
                let mut watch = watch.lock().unwrap_or_else(PoisonError::into_inner);
                watch.take_state(Instant::now(), key, &bytes);
            });
        states
            .background()
            .wait()
            .map_err(|error| anyhow!("{error}"))?;
        let watch = Arc::clone(&self.watch);
        let liveliness = session.liveliness();
        let tokens = liveliness
            .declare_subscriber(ALL_TOKENS)
            .history(true)
            .callback(move |sample| {
                let is_alive = sample.kind() == SampleKind::Put;
                let mut watch = watch.lock().unwrap_or_else(PoisonError::into_inner);
                watch.take_token(Instant::now(), sample.key_expr().as_str(), is_alive);
            });
        tokens
            .background()
            .wait()
            .map_err(|error| anyhow!("{error}"))?;
        // It is opened once.
        let _ = self.session.set(session);
        Ok(())
    }

    /// What is known now.
    #[must_use]
    pub fn view(&self) -> View {
        let session = self.session.get();
        let has_router =
            session.is_some_and(|session| session.info().routers_zid().wait().next().is_some());
        let mut watch = self.watch.lock().unwrap_or_else(PoisonError::into_inner);
        View {
            rows: watch.rows(Instant::now()),
            ignored: watch.ignored(),
            has_router,
        }
    }
}

/// Opens a session.
///
/// # Errors
///
/// When there is no router.
pub fn open(config: Config) -> Result<Session> {
    let session = zenoh::open(config).wait();
    session.map_err(|error| {
        // Behind it stands the place in the source of Zenoh.
        let error = error.to_string();
        let why = error.split(" at /").next().unwrap_or_default();
        anyhow!("no Zenoh router: start zenohd, or name one with --connect ({why})")
    })
}
