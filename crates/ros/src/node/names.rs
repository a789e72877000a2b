//! Key expressions of topics and services, and the tokens that show this node to others, as `rmw_zenoh` forms them.
//!
//! | what | key expression |
//! |---|---|
//! | topic, service | `DOMAIN/NAME/TYPE/HASH` |
//! | node | `@ros2_lv/DOMAIN/SESSION/0/0/NN/%/NAMESPACE/NODE` |
//! | publisher and so on | `@ros2_lv/DOMAIN/SESSION/0/NUMBER/KIND/%/NAMESPACE/NODE/NAME/TYPE/HASH/QOS` |
//!
//! In tokens `%` stands for each `/` of a name.

use std::{
    fmt,
    hash::{DefaultHasher, Hash as _, Hasher as _},
};

use anyhow::{Result, bail};

use super::messages::RosType;

/// What a node has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It publishes to a topic.
    Publisher,
    /// It takes the messages of a topic.
    Subscription,
    /// It answers requests.
    Service,
}

impl Kind {
    const fn code(self) -> &'static str {
        match self {
            Self::Publisher => "MP",
            Self::Subscription => "MS",
            Self::Service => "SS",
        }
    }
}

/// The name of a node, and where it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeName {
    domain: u16,
    /// Empty, or `/robot1`.
    namespace: String,
    name: String,
}

impl fmt::Display for NodeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.namespace, self.name)
    }
}

/// A publisher, subscription or service.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint {
    node: NodeName,
    kind: Kind,
    id: u32,
    /// From `/` on.
    name: String,
    type_name: &'static str,
    hash: &'static str,
    depth: u32,
}

impl NodeName {
    /// A node in this domain.
    ///
    /// # Errors
    ///
    /// When a part of the name is not letters, digits and `_`, or begins with a digit.
    pub fn new(domain: u16, namespace: &str, name: &str) -> Result<Self> {
        let namespace = namespace.trim_matches('/');
        let parts = namespace.split('/').filter(|_| !namespace.is_empty());
        for part in parts.chain([name]) {
            let is_name = part
                .chars()
                .all(|char| char.is_ascii_alphanumeric() || char == '_');
            if !is_name || !part.starts_with(|char: char| char.is_ascii_alphabetic() || char == '_')
            {
                bail!("{part:?} is no name in ROS: letters, digits and _, no digit first");
            }
        }
        Ok(Self {
            domain,
            namespace: if namespace.is_empty() {
                String::new()
            } else {
                format!("/{namespace}")
            },
            name: name.to_owned(),
        })
    }

    /// The token of the node in this session.
    #[must_use]
    pub fn token(&self, session: &str) -> String {
        self.token_of(session, 0, "NN")
    }

    fn token_of(&self, session: &str, id: u32, kind: &str) -> String {
        let namespace = match self.namespace.as_str() {
            "" => "%".to_owned(),
            namespace => mangled(namespace),
        };
        format!(
            "@ros2_lv/{}/{session}/0/{id}/{kind}/%/{namespace}/{}",
            self.domain, self.name
        )
    }

    /// A part of the node. A name that does not begin with `/` is within its namespace.
    #[must_use]
    pub fn endpoint<T: RosType>(&self, kind: Kind, id: u32, name: &str, depth: u32) -> Endpoint {
        let name = if name.starts_with('/') {
            name.to_owned()
        } else {
            format!("{}/{name}", self.namespace)
        };
        Endpoint {
            node: self.clone(),
            kind,
            id,
            name,
            type_name: T::NAME,
            hash: T::HASH,
            depth,
        }
    }
}

impl Endpoint {
    /// Where its messages go.
    #[must_use]
    pub fn key(&self) -> String {
        let name = self.name.trim_matches('/');
        let domain = self.node.domain;
        format!("{domain}/{name}/{}/RIHS01_{}", self.type_name, self.hash)
    }

    /// Its token in this session. Quality of service: reliable, volatile and the last ones, as the defaults, which are left out; the
    /// depth.
    #[must_use]
    pub fn token(&self, session: &str) -> String {
        format!(
            "{}/{}/{}/RIHS01_{}/::,{}:,:,:,,",
            self.node.token_of(session, self.id, self.kind.code()),
            mangled(&self.name),
            self.type_name,
            self.hash,
            self.depth
        )
    }

    /// Its identity in the attachment of its messages: no other endpoint has the same.
    #[must_use]
    pub fn sender(&self, session: &str) -> [u8; 16] {
        let half = |salt: u8| {
            let mut hasher = DefaultHasher::new();
            (salt, self.token(session)).hash(&mut hasher);
            hasher.finish()
        };
        let both = u128::from(half(0)) << 64 | u128::from(half(1));
        both.to_le_bytes()
    }
}

fn mangled(name: &str) -> String {
    name.replace('/', "%")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::node::messages::Temperature;

    const HASH: &str = "72514a14126ab9f8a9abec974c78e5610a367b59db5da355ff1fb982d5bad4b8";

    #[test]
    fn keys_and_tokens_are_those_of_rmw_zenoh() {
        let node = NodeName::new(2, "/", "motorlink").unwrap();
        assert_eq!(node.token("a1"), "@ros2_lv/2/a1/0/0/NN/%/%/motorlink");
        let topic = node.endpoint::<Temperature>(Kind::Publisher, 10, "motor_1/temperature", 7);
        assert_eq!(
            topic.key(),
            format!("2/motor_1/temperature/sensor_msgs::msg::dds_::Temperature_/RIHS01_{HASH}")
        );
        assert_eq!(
            topic.token("a1"),
            format!(
                "@ros2_lv/2/a1/0/10/MP/%/%/motorlink/%motor_1%temperature/sensor_msgs::msg::dds_::Temperature_/RIHS01_{HASH}/::,7:,:,:,,"
            )
        );
    }

    #[test]
    fn a_namespace_is_before_relative_names_only() {
        let node = NodeName::new(0, "robots/one", "motorlink").unwrap();
        assert_eq!(
            node.token("a1"),
            "@ros2_lv/0/a1/0/0/NN/%/%robots%one/motorlink"
        );
        let key = |name| {
            let topic = node.endpoint::<Temperature>(Kind::Subscription, 1, name, 1);
            topic.key()
        };
        assert!(key("odom").starts_with("0/robots/one/odom/sensor_msgs::"));
        assert!(key("/tf").starts_with("0/tf/sensor_msgs::"));
    }

    #[test]
    fn a_name_that_ros_does_not_know_is_an_error() {
        for (namespace, name) in [
            ("", ""),
            ("", "1a"),
            ("", "a b"),
            ("a//b", "c"),
            ("a-b", "c"),
        ] {
            assert!(
                NodeName::new(0, namespace, name).is_err(),
                "{namespace} {name}"
            );
        }
    }

    #[test]
    fn two_endpoints_have_different_identities() {
        let node = NodeName::new(0, "", "motorlink").unwrap();
        let of = |id| {
            node.endpoint::<Temperature>(Kind::Publisher, id, "a", 1)
                .sender("a1")
        };
        assert_ne!(of(1), of(2));
    }
}
