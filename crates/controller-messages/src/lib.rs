//! The messages of the socket for a controller, and their bytes. The server (`crates/remote-server`) and the clients that are
//! written in Rust (`crates/ros`) share them. `docs/socket.md` has the tables.

mod bytes;
mod messages;

pub use bytes::{
    check_hello, check_server_hello, client_hello, decode_from_client, decode_from_server,
    encode_error, encode_from_client, encode_state, server_hello,
};
pub use messages::{
    Activity, DriveState, EndReason, FROM_CLIENT, FROM_SERVER, FromClient, FromServer, HELLO,
    Holder, MAGIC, MOTORS_MAX, Motor, NotArmed, Refusal, Setpoints, State, VERSION,
};
