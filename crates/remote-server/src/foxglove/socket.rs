//! The connection of one client.

use std::time::Duration;

use axum::{
    body::Bytes,
    extract::{
        FromRequestParts,
        ws::{Message, WebSocket, WebSocketUpgrade},
    },
    http::{StatusCode, request::Parts},
    response::{IntoResponse, Response},
};
use futures_util::{
    SinkExt, StreamExt,
    stream::{SplitSink, SplitStream},
};
use tokio::{
    sync::mpsc,
    time::{interval, timeout},
};

use super::{
    clients::{ClientId, Clients},
    protocol::SUBPROTOCOLS,
};
use crate::socket::{Close, RATE_MAX, Rate, SEND_MAX, close};

/// The longest message of a client: subscriptions to the channels of 254 motors at once have 20 kB.
const MESSAGE_MAX: usize = 32 * 1024;
/// A client may say nothing for hours, but its library answers pings.
const PING_EVERY: Duration = Duration::from_secs(10);
/// The network has gone if three pings were not answered.
const SILENCE_MAX: Duration = Duration::from_secs(35);

/// Answers the request for a WebSocket.
pub(crate) async fn answer(parts: &mut Parts, clients: Clients) -> Response {
    let upgrade = match WebSocketUpgrade::from_request_parts(parts, &()).await {
        Ok(upgrade) => upgrade.protocols(SUBPROTOCOLS),
        Err(refused) => return refused.into_response(),
    };
    if upgrade.selected_protocol().is_none() {
        let text =
            "This address is for the subprotocol foxglove.sdk.v1 or foxglove.websocket.v1.\n";
        return (StatusCode::BAD_REQUEST, text).into_response();
    }
    upgrade
        .max_message_size(MESSAGE_MAX)
        .max_frame_size(MESSAGE_MAX)
        .on_upgrade(move |socket| serve(socket, clients))
}

async fn serve(socket: WebSocket, clients: Clients) {
    let Some((id, frames)) = clients.join() else {
        close(socket, Close::TooMany).await;
        return;
    };
    let (sink, stream) = socket.split();
    tokio::select! {
        () = receive(stream, &clients, id) => {}
        () = send(sink, frames) => {}
    }
    clients.leave(id);
}

/// Takes the messages of a client until it goes, or sends too much.
async fn receive(mut stream: SplitStream<WebSocket>, clients: &Clients, id: ClientId) {
    let mut rate = Rate::default();
    while let Ok(Some(Ok(message))) = timeout(SILENCE_MAX, stream.next()).await {
        if rate.is_above(RATE_MAX) {
            return;
        }
        match message {
            Message::Text(text) => clients.received(id, &text),
            Message::Binary(_) => clients.received_bytes(id),
            Message::Close(_) => return,
            // The library answers pings.
            Message::Ping(_) | Message::Pong(_) => {}
        }
    }
}

/// Sends what waits for a client until it takes nothing.
async fn send(mut sink: SplitSink<WebSocket, Message>, mut frames: mpsc::Receiver<Message>) {
    let mut ping = interval(PING_EVERY);
    loop {
        let message = tokio::select! {
            frame = frames.recv() => match frame {
                Some(frame) => frame,
                None => return,
            },
            _ = ping.tick() => Message::Ping(Bytes::new()),
        };
        let sent = timeout(SEND_MAX, sink.send(message)).await;
        if !matches!(sent, Ok(Ok(()))) {
            return;
        }
    }
}
