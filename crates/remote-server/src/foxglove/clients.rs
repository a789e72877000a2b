//! The clients that are connected, and what they subscribe to.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{SystemTime, UNIX_EPOCH},
};

use axum::extract::ws::Message as Frame;
use motorlink_protocol::MotorId;
use motorlink_session::{Channel, Message};
use tokio::sync::mpsc;

use super::{
    plot,
    protocol::{self, Level, Offered, Request},
};

/// Clients at the same time: several persons with two programs each.
pub(super) const CLIENTS_MAX: usize = 8;
/// Messages that wait for a client: two seconds of 500 replies a second. A slower client misses some.
const QUEUE: usize = 1_024;

/// The channels that are there before any motor has replied.
const CHANNELS: [Offered; 3] = [
    Offered::Session(Channel::Wire),
    Offered::Session(Channel::Events),
    Offered::Session(Channel::Link),
];

/// A client, for as long as it is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ClientId(u64);

/// The clients, shared by their connections and the feed.
#[derive(Clone, Debug)]
pub(crate) struct Clients(Arc<Mutex<State>>);

#[derive(Debug)]
struct State {
    session: String,
    joined: u64,
    clients: BTreeMap<ClientId, Client>,
    /// The motors whose channel is advertised.
    motors: BTreeSet<MotorId>,
}

#[derive(Debug)]
struct Client {
    queue: mpsc::Sender<Frame>,
    /// By the number of the channel.
    subscriptions: BTreeMap<u32, u32>,
    /// Messages that it has missed.
    missed: u64,
    /// Whether it misses messages until half of its queue is free.
    is_behind: bool,
}

impl Clients {
    /// None yet.
    pub(crate) fn new() -> Self {
        let started = SystemTime::now().duration_since(UNIX_EPOCH);
        Self(Arc::new(Mutex::new(State {
            session: started.unwrap_or_default().as_millis().to_string(),
            joined: 0,
            clients: BTreeMap::new(),
            motors: BTreeSet::new(),
        })))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A client has connected. Returns what is sent to it, or nothing if there are too many.
    pub(super) fn join(&self) -> Option<(ClientId, mpsc::Receiver<Frame>)> {
        let mut state = self.state();
        if state.clients.len() >= CLIENTS_MAX {
            return None;
        }
        state.joined += 1;
        let id = ClientId(state.joined);
        let (queue, frames) = mpsc::channel(QUEUE);
        let client = Client {
            queue,
            subscriptions: BTreeMap::new(),
            missed: 0,
            is_behind: false,
        };
        client.tell(protocol::server_info(&state.session));
        client.tell(protocol::advertise(&offered(&state.motors)));
        state.clients.insert(id, client);
        Some((id, frames))
    }

    pub(super) fn leave(&self, id: ClientId) {
        self.state().clients.remove(&id);
    }

    /// A text of a client. Whatever it asks for, nothing but its own subscriptions changes.
    pub(super) fn received(&self, id: ClientId, text: &str) {
        // Before the lock: what one client sends delays no other.
        let request = Request::read(text);
        let mut state = self.state();
        let State {
            clients, motors, ..
        } = &mut *state;
        let Some(client) = clients.get_mut(&id) else {
            return;
        };
        match request {
            Some(Request::Subscribe(pairs)) => client.subscribe(&pairs, motors),
            Some(Request::Unsubscribe(ids)) => {
                let ids: BTreeSet<u32> = ids.into_iter().collect();
                client.subscriptions.retain(|_, id| !ids.contains(id));
            }
            Some(Request::Other) => {
                client.complain("This server is read-only: it tells what happens on the line.");
            }
            None => client.complain("The message is not of Foxglove's WebSocket protocol."),
        }
    }

    /// A client has sent bytes: a message to publish, or the call of a service.
    pub(super) fn received_bytes(&self, id: ClientId) {
        if let Some(client) = self.state().clients.get(&id) {
            client.complain("This server is read-only: it takes no messages.");
        }
    }

    /// Whether a message would reach a client.
    pub(super) fn are_subscribed(&self) -> bool {
        let state = self.state();
        let mut clients = state.clients.values();
        clients.any(|client| !client.subscriptions.is_empty())
    }

    /// Tells every client of the channel of a motor.
    pub(super) fn add_motor(&self, id: MotorId) {
        let mut state = self.state();
        if state.motors.insert(id) {
            let text = protocol::advertise(&Offered::of_motor(id));
            for client in state.clients.values() {
                client.tell(text.clone());
            }
        }
    }

    /// Gives a message to those who subscribe to its channel. It never waits.
    pub(super) fn put(&self, message: &Message<'_>) {
        let channel = Offered::Session(message.channel).number();
        let mut state = self.state();
        let clients = &mut state.clients;
        for client in clients.values_mut() {
            client.put(channel, message.log_ns, message.json.as_bytes());
        }
        let Channel::Telemetry(id) = message.channel else {
            return;
        };
        let channel = Offered::Plot(id).number();
        let is_subscribed = |client: &Client| client.subscriptions.contains_key(&channel);
        if clients.values().any(is_subscribed) {
            let data = plot::message(message.json);
            for client in clients.values_mut() {
                client.put(channel, message.log_ns, &data);
            }
        }
    }
}

/// The channels where these motors have replied.
fn offered(motors: &BTreeSet<MotorId>) -> Vec<Offered> {
    let of_motors = motors.iter().flat_map(|id| Offered::of_motor(*id));
    CHANNELS.into_iter().chain(of_motors).collect()
}

impl Client {
    fn tell(&self, text: String) {
        // A client that takes nothing misses it.
        let _ = self.queue.try_send(Frame::Text(text.into()));
    }

    fn complain(&self, text: &str) {
        self.tell(protocol::status(Level::Error, "request", text));
    }

    fn subscribe(&mut self, pairs: &[(u32, u32)], motors: &BTreeSet<MotorId>) {
        let channels = offered(motors).into_iter().map(Offered::number);
        let channels: BTreeSet<u32> = channels.collect();
        let mut ids: BTreeSet<u32> = self.subscriptions.values().copied().collect();
        let mut wrong = None;
        for (id, channel) in pairs {
            if !channels.contains(channel) {
                wrong = Some(format!("There is no channel {channel}."));
            } else if self.subscriptions.contains_key(channel) || !ids.insert(*id) {
                wrong = Some("A channel and a subscription are used once.".to_owned());
            } else {
                self.subscriptions.insert(*channel, *id);
                continue;
            }
            // The hub waits for the lock: no more work than one complaint.
            break;
        }
        if let Some(wrong) = wrong {
            self.complain(&wrong);
        }
    }

    fn put(&mut self, channel: u32, log_ns: u64, data: &[u8]) {
        let Some(subscription) = self.subscriptions.get(&channel) else {
            return;
        };
        if self.is_behind && self.queue.capacity() >= QUEUE / 2 {
            self.is_behind = false;
            let missed = self.missed;
            let text = format!("The connection is too slow: {missed} messages were left out.");
            self.tell(protocol::status(Level::Warning, "slow", &text));
        }
        let frame = || Frame::Binary(protocol::message_data(*subscription, log_ns, data));
        if self.is_behind || self.queue.try_send(frame()).is_err() {
            self.is_behind = true;
            self.missed += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MESSAGE: Message<'_> = Message {
        channel: Channel::Wire,
        log_ns: 1,
        json: "{}",
    };

    fn is_data(frame: &Frame) -> bool {
        matches!(frame, Frame::Binary(_))
    }

    #[test]
    fn a_slow_client_misses_messages_and_is_told_while_others_get_all() {
        let clients = Clients::new();
        let (slow, mut slow_frames) = clients.join().unwrap();
        let (other, mut other_frames) = clients.join().unwrap();
        assert!(!clients.are_subscribed());
        for id in [slow, other] {
            clients.received(
                id,
                r#"{"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]}"#,
            );
        }
        assert!(clients.are_subscribed());
        let mut taken = 0;
        for _ in 0..3_000 {
            clients.put(&MESSAGE);
            while let Ok(frame) = other_frames.try_recv() {
                taken += usize::from(is_data(&frame));
            }
        }
        assert_eq!(taken, 3_000);
        // It takes a few: it still misses all.
        for _ in 0..10 {
            slow_frames.try_recv().unwrap();
        }
        clients.put(&MESSAGE);
        let mut texts = Vec::new();
        let mut kept = 0;
        while let Ok(frame) = slow_frames.try_recv() {
            kept += usize::from(is_data(&frame));
        }
        clients.put(&MESSAGE);
        while let Ok(frame) = slow_frames.try_recv() {
            match frame {
                Frame::Text(text) => texts.push(text.to_string()),
                _ => kept += 1,
            }
        }
        // The queue began with two texts, and eight messages were taken with them.
        assert_eq!(kept, QUEUE - 10 + 1);
        let expected = protocol::status(
            Level::Warning,
            "slow",
            "The connection is too slow: 1979 messages were left out.",
        );
        assert_eq!(texts, [expected]);
    }

    #[test]
    fn subscriptions_begin_and_end_and_wrong_ones_are_refused() {
        let clients = Clients::new();
        let (id, mut frames) = clients.join().unwrap();
        clients.add_motor(MotorId::FIRST);
        let wrong = [
            r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":258}]}"#,
            r#"{"op":"advertise","channels":[]}"#,
            "garbage",
        ];
        for text in wrong {
            clients.received(id, text);
        }
        assert!(!clients.are_subscribed());
        clients.received(
            id,
            r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":257},{"id":1,"channelId":2},{"id":2,"channelId":257}]}"#,
        );
        clients.received(id, r#"{"op":"unsubscribe","subscriptionIds":[9]}"#);
        assert!(clients.are_subscribed());
        clients.received(id, r#"{"op":"unsubscribe","subscriptionIds":[1]}"#);
        assert!(!clients.are_subscribed());
        clients.received_bytes(id);
        let mut texts = Vec::new();
        while let Ok(Frame::Text(text)) = frames.try_recv() {
            texts.push(text.to_string());
        }
        let count = |op: &str| texts.iter().filter(|text| text.contains(op)).count();
        let counts = ["serverInfo", "\"advertise\"", "\"status\""].map(count);
        assert_eq!(counts, [1, 2, 5], "{texts:?}");
    }

    #[test]
    fn clients_are_limited() {
        let clients = Clients::new();
        let joined: Vec<_> = (0..CLIENTS_MAX).map(|_| clients.join().unwrap()).collect();
        assert!(clients.join().is_none());
        clients.leave(joined[3].0);
        assert!(clients.join().is_some());
    }
}
