//! A node of ROS 2 over Zenoh, without ROS: what `rmw_zenoh` does for a node, as far as this program needs it.
//!
//! | file | idea |
//! |---|---|
//! | `messages` | the messages as CDR, with the names and hashes of their types |
//! | `names` | key expressions of topics, and the tokens that show this node to others |
//! | `attachment` | number, time and sender of each message |
//!
//! Sources: the design page of `rmw_zenoh` and its `liveliness_utils.cpp` and `attachment_helpers.cpp` (`ros2/rmw_zenoh`), and `hiroz`,
//! which the tests let read and write what this does.

pub mod attachment;
pub mod messages;
pub mod names;

use std::sync::atomic::{AtomicI64, AtomicU32, Ordering};

use anyhow::{Result, anyhow};
use serde::Serialize;
use zenoh::{
    Config, Session, Wait as _,
    liveliness::LivelinessToken,
    pubsub::{Publisher, Subscriber},
    qos::CongestionControl,
    query::{Query, Queryable},
    sample::Sample,
};

use attachment::Attachment;
use messages::{RosType, encode};
use names::{Endpoint, Kind, NodeName};

/// A node. Dropped, it has gone for the other nodes, too.
pub struct Node {
    session: Session,
    name: NodeName,
    next: AtomicU32,
    _token: LivelinessToken,
}

/// A topic to which the node publishes messages of one type.
pub struct Topic {
    publisher: Publisher<'static>,
    sender: [u8; 16],
    sent: AtomicI64,
    _token: LivelinessToken,
}

/// A topic or service that the node listens to.
pub struct Listening {
    _listens: Listener,
    _token: LivelinessToken,
}

/// Ends when it is dropped.
enum Listener {
    Topic(#[expect(dead_code, reason = "it is only dropped")] Subscriber<()>),
    Service(#[expect(dead_code, reason = "it is only dropped")] Queryable<()>),
}

impl Node {
    /// Opens a session and appears as a node.
    ///
    /// # Errors
    ///
    /// For a configuration that Zenoh refuses, and for a name that is no name in ROS. A router that is not there is no error:
    /// Zenoh connects when it comes.
    pub fn open(config: Config, name: NodeName) -> Result<Self> {
        let session = zenoh::open(config).wait().map_err(error)?;
        let token = name.token(&session.zid().to_string());
        let token = session
            .liveliness()
            .declare_token(token)
            .wait()
            .map_err(error)?;
        Ok(Self {
            session,
            name,
            // 0 is the node itself.
            next: AtomicU32::new(1),
            _token: token,
        })
    }

    /// A topic for messages of this type. A relative name is within the namespace of the node.
    ///
    /// # Errors
    ///
    /// What Zenoh says.
    pub fn publish<T: RosType>(&self, topic: &str, depth: u32) -> Result<Topic> {
        let endpoint = self.endpoint::<T>(Kind::Publisher, topic, depth);
        let publisher = self
            .session
            .declare_publisher(endpoint.key())
            // A network that is slow delays no later message.
            .congestion_control(CongestionControl::Drop)
            .wait()
            .map_err(error)?;
        Ok(Topic {
            publisher,
            sender: endpoint.sender(&self.zid()),
            sent: AtomicI64::new(0),
            _token: self.appear(&endpoint)?,
        })
    }

    /// Calls `take` with the bytes and the attachment of each message of this type. One without an attachment is ignored. `take` is called in a thread
    /// of Zenoh.
    ///
    /// # Errors
    ///
    /// What Zenoh says.
    pub fn subscribe<T: RosType>(
        &self,
        topic: &str,
        take: impl Fn(&[u8], Attachment) + Send + Sync + 'static,
    ) -> Result<Listening> {
        let endpoint = self.endpoint::<T>(Kind::Subscription, topic, 1);
        let on_sample = move |sample: Sample| {
            // Without it, or of another `rmw_zenoh`: when the message was sent is not known.
            if let Some(attachment) = sample.attachment().and_then(Attachment::read) {
                take(&sample.payload().to_bytes(), attachment);
            }
        };
        let subscriber = self
            .session
            .declare_subscriber(endpoint.key())
            .callback(on_sample)
            .wait()
            .map_err(error)?;
        Ok(Listening {
            _listens: Listener::Topic(subscriber),
            _token: self.appear(&endpoint)?,
        })
    }

    /// Calls `take` with each request of this service. `take` is called in a thread of Zenoh.
    ///
    /// # Errors
    ///
    /// What Zenoh says.
    pub fn serve<T: RosType>(
        &self,
        service: &str,
        take: impl Fn(Request) + Send + Sync + 'static,
    ) -> Result<Listening> {
        let endpoint = self.endpoint::<T>(Kind::Service, service, 10);
        let queryable = self
            .session
            .declare_queryable(endpoint.key())
            .complete(true)
            .callback(move |query| take(Request(query)))
            .wait()
            .map_err(error)?;
        Ok(Listening {
            _listens: Listener::Service(queryable),
            _token: self.appear(&endpoint)?,
        })
    }

    /// Whether it is connected to a router. Without one, it finds no other node.
    #[must_use]
    pub fn has_router(&self) -> bool {
        self.session.info().routers_zid().wait().next().is_some()
    }

    /// Its session of Zenoh.
    #[must_use]
    pub const fn session(&self) -> &Session {
        &self.session
    }

    /// Leaves the network.
    pub fn close(&self) {
        // The program ends in any case.
        let _ = self.session.close().wait();
    }

    /// The ID of its session.
    #[must_use]
    pub fn zid(&self) -> String {
        self.session.zid().to_string()
    }

    fn endpoint<T: RosType>(&self, kind: Kind, name: &str, depth: u32) -> Endpoint {
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        self.name.endpoint::<T>(kind, id, name, depth)
    }

    fn appear(&self, endpoint: &Endpoint) -> Result<LivelinessToken> {
        let token = endpoint.token(&self.zid());
        let declared = self.session.liveliness().declare_token(token).wait();
        declared.map_err(error)
    }
}

impl Topic {
    /// Sends a message.
    ///
    /// # Errors
    ///
    /// What Zenoh says.
    pub fn send<T: Serialize>(&self, message: &T) -> Result<()> {
        let number = self.sent.fetch_add(1, Ordering::Relaxed) + 1;
        let attachment = Attachment::now(number, self.sender);
        self.publisher
            .put(encode(message))
            .attachment(attachment.write())
            .wait()
            .map_err(error)
    }
}

/// A request of a service that waits for its answer.
pub struct Request(Query);

impl Request {
    /// Answers it.
    pub fn answer<T: Serialize>(self, message: &T) {
        let key = self.0.key_expr().clone();
        let request = self.0.attachment().and_then(Attachment::read);
        let mut reply = self.0.reply(key, encode(message));
        // The client knows its request by number and sender.
        if let Some(request) = request {
            let attachment = Attachment::now(request.number, request.sender);
            reply = reply.attachment(attachment.write());
        }
        // The client may have gone.
        let _ = reply.wait();
    }
}

#[expect(clippy::needless_pass_by_value, reason = "as map_err gives it")]
fn error(error: zenoh::Error) -> anyhow::Error {
    anyhow!("{error}")
}
