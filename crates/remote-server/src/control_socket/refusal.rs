//! Closes a connection with the reason.

use std::time::Duration;

use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::unix::{OwnedReadHalf, OwnedWriteHalf},
    time::timeout,
};

/// How long a client may take for its first bytes, and to take a message. One that takes longer has gone.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);
/// How long a refusal may take.
const REFUSAL_MAX: Duration = Duration::from_millis(500);

/// Says why the connection is closed. What the client has sent is taken: otherwise the system resets the connection.
pub(super) async fn refuse(mut read: OwnedReadHalf, mut write: OwnedWriteHalf, why: &[u8]) {
    let said = async {
        // It may have gone.
        let _ = write.write_all(why).await;
        let _ = write.shutdown().await;
        let mut bytes = [0; 256];
        for _ in 0..16 {
            if !matches!(read.read(&mut bytes).await, Ok(1..)) {
                return;
            }
        }
    };
    let _ = timeout(REFUSAL_MAX, said).await;
}
