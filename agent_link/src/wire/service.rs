//! What vehicles say to each other.

use agent_core::model::{Fact, Task, Time};
use agent_core::protocol::{ActionId, Urgency};
use agent_core::service;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::text::{from_text, to_text};
use super::{Text, VERSION, WireError};

#[derive(Serialize, Deserialize)]
struct Message {
    v: u32,
    by: String,
    t_s: f64,
    #[serde(flatten)]
    body: Body,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Body {
    Tasks {
        offers: Vec<Offer>,
        awards: Vec<Award>,
        /// In hexadecimal: not all who read JSON know whole numbers of this size.
        digest: String,
    },
    Bid {
        id: Text<ActionId>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        cost_s: Option<f64>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        lacks: Vec<Text<Fact>>,
    },
    Told(Vec<Told>),
    Need(Vec<Text<Fact>>),
}

#[derive(Serialize, Deserialize)]
struct Offer {
    task: String,
    id: Text<ActionId>,
    what: Text<Task>,
    #[serde(default)]
    emergency: bool,
    #[serde(default)]
    priority: i32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    deadline_s: Option<f64>,
}

#[derive(Serialize, Deserialize)]
struct Award {
    task: String,
    id: Text<ActionId>,
    what: Text<Task>,
    to: String,
}

#[derive(Serialize, Deserialize)]
struct Told {
    fact: Text<Fact>,
    holds: bool,
    source: String,
    t_s: f64,
}

/// A message from one vehicle to all others, as it travels.
///
/// # Errors
/// If it is one that no vehicle says to others.
pub fn service_to_wire(message: &service::Message) -> Result<Value, WireError> {
    let body = match &message.body {
        service::Body::Tasks(tasks) => Body::Tasks {
            offers: tasks.offers.iter().map(offer_to_wire).collect(),
            awards: tasks.awards.iter().map(award_to_wire).collect(),
            digest: format!("{:016x}", tasks.digest),
        },
        service::Body::Bid(bid) => Body::Bid {
            id: Text(bid.id.clone()),
            cost_s: bid.cost.map(Time::secs),
            lacks: to_text(&bid.lacks),
        },
        service::Body::Told(told) => Body::Told(told.iter().map(told_to_wire).collect()),
        service::Body::Need(facts) => Body::Need(to_text(facts)),
        service::Body::Goal(_) => {
            let why = "a user's goal is not said to all";
            return Err(WireError::malformed("own message", why));
        }
    };
    super::to_value(&Message {
        v: VERSION,
        by: message.by.to_string(),
        t_s: message.at.secs(),
        body,
    })
}

/// A message from another vehicle.
///
/// # Errors
/// If it is none.
pub fn service_from_wire(value: Value) -> Result<service::Message, WireError> {
    const WHAT: &str = "message of a vehicle";
    let message: Message = super::from_value(WHAT, value)?;
    let body = match message.body {
        Body::Tasks {
            offers,
            awards,
            digest,
        } => service::Body::Tasks(service::Tasks {
            offers: offers.into_iter().map(offer_from_wire).collect(),
            awards: awards.into_iter().map(award_from_wire).collect(),
            digest: u64::from_str_radix(&digest, 16)
                .map_err(|error| WireError::malformed(WHAT, error))?,
        }),
        Body::Bid { id, cost_s, lacks } => service::Body::Bid(service::Bid {
            id: id.0,
            cost: cost_s.map(Time::from_secs),
            lacks: from_text(lacks),
        }),
        Body::Told(told) => service::Body::Told(told.into_iter().map(told_from_wire).collect()),
        Body::Need(facts) => service::Body::Need(from_text(facts)),
    };
    Ok(service::Message {
        by: message.by.into(),
        at: Time::from_secs(message.t_s),
        body,
    })
}

fn offer_to_wire(offer: &service::Offer) -> Offer {
    Offer {
        task: offer.task.to_string(),
        id: Text(offer.id.clone()),
        what: Text(offer.what.clone()),
        emergency: offer.urgency == Urgency::Emergency,
        priority: offer.priority,
        deadline_s: offer.deadline.map(Time::secs),
    }
}

fn offer_from_wire(offer: Offer) -> service::Offer {
    service::Offer {
        task: offer.task.into(),
        id: offer.id.0,
        what: offer.what.0,
        urgency: match offer.emergency {
            true => Urgency::Emergency,
            false => Urgency::Normal,
        },
        priority: offer.priority,
        deadline: offer.deadline_s.map(Time::from_secs),
    }
}

fn award_to_wire(award: &service::Award) -> Award {
    Award {
        task: award.task.to_string(),
        id: Text(award.id.clone()),
        what: Text(award.what.clone()),
        to: award.to.to_string(),
    }
}

fn award_from_wire(award: Award) -> service::Award {
    service::Award {
        task: award.task.into(),
        id: award.id.0,
        what: award.what.0,
        to: award.to.into(),
    }
}

fn told_to_wire(told: &service::Told) -> Told {
    Told {
        fact: Text(told.fact.clone()),
        holds: told.holds,
        source: told.source.to_string(),
        t_s: told.at.secs(),
    }
}

fn told_from_wire(told: Told) -> service::Told {
    service::Told {
        fact: told.fact.0,
        holds: told.holds,
        source: told.source.into(),
        at: Time::from_secs(told.t_s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use agent_core::model::Atom;
    use serde_json::json;

    fn id() -> ActionId {
        ActionId {
            agent: "k2".into(),
            epoch: 3,
            number: 7,
        }
    }

    #[test]
    fn what_is_said_comes_out_as_it_went_in() {
        let fact = Atom::new("seated", ["ann", "table1"]);
        let what = Atom::new("serve", ["cola", "ann"]);
        let bodies = [
            service::Body::Tasks(service::Tasks {
                offers: vec![service::Offer {
                    task: "t1".into(),
                    id: id(),
                    what: what.clone(),
                    urgency: Urgency::Emergency,
                    priority: -2,
                    deadline: Some(Time(7_000_001)),
                }],
                awards: vec![service::Award {
                    task: "t2".into(),
                    id: id(),
                    what,
                    to: "k3".into(),
                }],
                digest: u64::MAX - 5,
            }),
            service::Body::Bid(service::Bid {
                id: id(),
                cost: Some(Time(1_234_567)),
                lacks: vec![fact.clone()],
            }),
            service::Body::Bid(service::Bid {
                id: id(),
                cost: None,
                lacks: vec![],
            }),
            service::Body::Told(vec![service::Told {
                fact: fact.clone(),
                holds: false,
                source: "k1".into(),
                at: Time(99),
            }]),
            service::Body::Need(vec![fact]),
        ];
        for body in bodies {
            let message = service::Message {
                by: "k2".into(),
                at: Time(12_345_678),
                body,
            };
            let value = service_to_wire(&message).unwrap();
            assert_eq!(service_from_wire(value).unwrap(), message);
        }
    }

    #[test]
    fn it_can_be_typed_by_hand() {
        let typed = json!({
            "v": 1, "by": "k1", "t_s": 12.5,
            "told": [{ "fact": "(spill table3)", "holds": true, "source": "k1", "t_s": 12.5 }],
        });
        let message = service_from_wire(typed).unwrap();
        assert_eq!(message.at, Time(12_500_000));
        assert!(matches!(message.body, service::Body::Told(told) if told[0].holds));
    }

    #[test]
    fn a_goal_is_not_said_to_all_and_nothing_else_is_believed() {
        let goal = json!({ "v": 1, "by": "k1", "t_s": 1.0, "goal": { "tasks": [] } });
        assert!(service_from_wire(goal).is_err());
        let later = json!({ "v": 2, "by": "k1", "t_s": 1.0, "need": [] });
        assert!(matches!(
            service_from_wire(later),
            Err(WireError::Version { .. })
        ));
    }
}
