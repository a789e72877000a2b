//! The connection of one page.

use std::{
    net::IpAddr,
    time::{Duration, Instant},
};

use axum::{
    body::Bytes,
    extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade},
    response::Response,
};
use futures_util::{Sink, SinkExt, StreamExt, stream::SplitStream};
use motorlink_remote::{FromServer, ViewerId};
use tokio::{sync::broadcast::error::RecvError, time::timeout};

use crate::{
    messages::PageRequest,
    viewers::{Outgoing, Viewers, encoded},
};

/// The longest message of a page: a sequence of an experiment. It is a hundred times as long as any other.
const MESSAGE_MAX: usize = 256 * 1024;
/// Messages of a page in a second: fifty answers, and two sliders at 60 Hz, of several seconds that a network has held back.
pub(crate) const RATE_MAX: u32 = 1_000;
/// How long a message may take to leave. A page that takes nothing for so long has gone.
pub(crate) const SEND_MAX: Duration = Duration::from_secs(5);
/// A page answers several challenges a second. The network has gone if nothing comes for so long.
const SILENCE_MAX: Duration = Duration::from_secs(10);

/// Why the server closes a new connection: a code of RFC 6455, and one of ours.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Close {
    TooMany = 1013,
    /// The page is of another version.
    OtherVersion = 4001,
}

/// Answers the request for a WebSocket. A page of another version is told so.
pub(crate) fn answer(
    upgrade: WebSocketUpgrade,
    (viewers, address): (Viewers, IpAddr),
    is_same_version: bool,
) -> Response {
    upgrade
        .max_message_size(MESSAGE_MAX)
        .max_frame_size(MESSAGE_MAX)
        .on_upgrade(move |socket| async move {
            if is_same_version {
                serve(socket, viewers, address).await;
            } else {
                close(socket, Close::OtherVersion).await;
            }
        })
}

pub(crate) async fn close(mut socket: WebSocket, why: Close) {
    let frame = CloseFrame {
        code: why as u16,
        reason: "".into(),
    };
    // It may have gone.
    let _ = timeout(SEND_MAX, socket.send(Message::Close(Some(frame)))).await;
}

async fn serve(socket: WebSocket, viewers: Viewers, address: IpAddr) {
    let Some((viewer, outgoing)) = viewers.join(address) else {
        close(socket, Close::TooMany).await;
        return;
    };
    let (sink, stream) = socket.split();
    // Apart: a page that takes nothing can still stop the motors.
    let sending = tokio::spawn(send(sink, outgoing));
    let abort = sending.abort_handle();
    let result = tokio::select! {
        result = receive(stream, &viewers, viewer) => result,
        _ = sending => Ok(()),
    };
    viewers.leave(viewer);
    abort.abort();
    if let Err(why) = result {
        viewers.log(format!("the page at {address} was disconnected: {why}"));
    }
}

/// The messages of a connection in this second.
pub(crate) struct Rate {
    since: Instant,
    messages: u32,
}

impl Default for Rate {
    fn default() -> Self {
        Self {
            since: Instant::now(),
            messages: 0,
        }
    }
}

impl Rate {
    /// Counts a message. Returns whether there are more than `max` in this second.
    pub(crate) fn is_above(&mut self, max: u32) -> bool {
        if self.since.elapsed() >= Duration::from_secs(1) {
            *self = Self::default();
        }
        self.messages += 1;
        self.messages > max
    }
}

/// Passes on the messages of a page until it goes.
async fn receive(
    mut stream: SplitStream<WebSocket>,
    viewers: &Viewers,
    viewer: ViewerId,
) -> Result<(), &'static str> {
    let mut rate = Rate::default();
    loop {
        let next = timeout(SILENCE_MAX, stream.next()).await;
        let Ok(Some(Ok(message))) = next else {
            return Ok(());
        };
        if rate.is_above(RATE_MAX) {
            return Err("it sends too much");
        }
        match message {
            Message::Binary(bytes) => {
                // Before the lock: what one page sends delays no other.
                let asks = PageRequest::read(&bytes).ok_or("its messages do not read")?;
                viewers.operate(|operation, now| operation.page_asks(now, viewer, asks));
            }
            Message::Text(_) => return Err("its messages do not read"),
            Message::Close(_) => return Ok(()),
            // The library answers them.
            Message::Ping(_) | Message::Pong(_) => {}
        }
    }
}

/// Sends what is for a page until it takes nothing. A page that is slow misses updates, and is told.
async fn send(mut sink: impl Sink<Message> + Unpin, mut outgoing: Outgoing) {
    loop {
        let bytes: Bytes = tokio::select! {
            // Challenges and control come first.
            biased;
            own = outgoing.own.recv() => match own {
                Some(bytes) => bytes,
                None => return,
            },
            update = outgoing.updates.recv() => match update {
                Ok(bytes) => bytes,
                Err(RecvError::Lagged(_)) => encoded(&FromServer::Missed),
                Err(RecvError::Closed) => return,
            },
        };
        let sent = timeout(SEND_MAX, sink.send(Message::Binary(bytes))).await;
        if !matches!(sent, Ok(Ok(()))) {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{cell::RefCell, convert::Infallible, future::ready};

    use futures_util::sink::unfold;
    use tokio::{
        runtime::Builder,
        sync::{broadcast, mpsc},
    };

    use super::*;

    #[test]
    fn a_slow_page_is_told_that_it_has_missed_something() {
        let (updates, slow) = broadcast::channel(2);
        for update in 0..5 {
            updates.send(Bytes::from(vec![update])).unwrap();
        }
        drop(updates);
        let (_page_stays, own) = mpsc::channel(1);
        let outgoing = Outgoing { own, updates: slow };
        let sent = RefCell::new(Vec::new());
        let take = |(), message| {
            sent.borrow_mut().push(message);
            ready(Ok::<_, Infallible>(()))
        };
        let runtime = Builder::new_current_thread().enable_time().build().unwrap();
        runtime.block_on(send(unfold((), take), outgoing));
        let missed = encoded(&FromServer::Missed);
        let expected = [missed, Bytes::from(vec![3]), Bytes::from(vec![4])];
        assert_eq!(*sent.borrow(), expected.map(Message::Binary));
    }
}
