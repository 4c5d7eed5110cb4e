//! `suspend`, `resume`, `cancel`, `fact` and `door`.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::language::{nearest, parse_fact_change};
use agent_core::model::{Atom, FactChange};
use agent_core::protocol::Command;
use agent_link::View;
use executor_sim::program::{ROOM, WORLD};
use serde_json::{Value, json};

use crate::cli::{CommandArgs, DoorArgs, DoorState, FactArgs};
use crate::exit::{Exit, Failure};
use crate::style::{BAD, GOOD};
use crate::target::{Connection, nobody, unanswered, unanswered_by};

/// Suspends, resumes or cancels a goal.
pub(crate) async fn command(
    args: CommandArgs,
    command: fn(agent_core::protocol::GoalId) -> Command,
    done: &str,
) -> Result<Exit, Failure> {
    let connection = Connection::open(&args.target).await?;
    let command = command(args.goal.as_str().into());
    let client = &connection.client;
    let verdict = match &args.vehicle {
        None => client.command(&command).await,
        Some(vehicle) => client.command_to(vehicle, &command).await,
    };
    let verdict = match (verdict, &args.vehicle) {
        (Err(error), Some(vehicle)) => Err(unanswered_by(client, vehicle, error).await),
        (verdict, _) => verdict.map_err(unanswered),
    };
    let verdict = connection.close(verdict).await?;
    let words = format!("{} {done}", args.goal);
    Ok(tell(
        json!(verdict),
        verdict.accepted,
        verdict.reason.as_deref(),
        &words,
        args.json,
    ))
}

/// Tells a robot what is different.
pub(crate) async fn fact(args: FactArgs) -> Result<Exit, Failure> {
    let fact = parse_fact_change(&args.fact).map_err(|error| {
        Failure::bad_input(format_args!("`{}` is not a fact: {error}", args.fact))
            .advice("for example: intermezzo fact '(not (open door3_5))'")
    })?;
    let connection = Connection::open(&args.target).await?;
    let told = async {
        let client = &connection.client;
        somebody_understands(&connection, &fact).await?;
        client.facts(&fact.to_string()).await.map_err(unanswered)
    }
    .await;
    let verdict = connection.close(told).await?;
    Ok(tell(
        json!(verdict),
        verdict.accepted,
        verdict.reason.as_deref(),
        &format!("told that {fact}"),
        args.json,
    ))
}

/// Refuses a fact that is in the words of no agent: nobody would take any notice of it.
async fn somebody_understands(connection: &Connection, fact: &FactChange) -> Result<(), Failure> {
    let client = &connection.client;
    let (FactChange::Add(atom) | FactChange::Remove(atom) | FactChange::Set(atom, _)) = fact;
    let mut words: BTreeMap<String, BTreeSet<u64>> = BTreeMap::new();
    let alive = client.alive().await.map_err(unanswered)?;
    if alive.is_empty() {
        return Err(nobody(&connection.keys));
    }
    let mut room = None;
    for (agent, _) in alive {
        let belief = client
            .look(&agent, View::Belief)
            .await
            .map_err(unanswered)?;
        if agent == ROOM {
            room = Some(belief["names"].clone());
        }
        for (word, arguments) in belief["words"].as_object().into_iter().flatten() {
            let known = words.entry(word.clone()).or_default();
            known.extend(arguments.as_u64());
        }
    }
    let Some(arguments) = words.get(atom.name.as_str()) else {
        let message = format!("no agent of this robot knows what `{}` means", atom.name);
        let failure = Failure::bad_input(message);
        let near = nearest(atom.name.as_str(), words.keys().map(String::as_str));
        return Err(match near {
            Some(near) => failure.advice(format_args!("did you mean `{near}`?")),
            None => failure,
        });
    };
    if arguments.contains(&(atom.args.len() as u64)) {
        return room.map_or(Ok(()), |names| the_room_takes_it(fact, atom, &names));
    }
    let wanted: Vec<String> = arguments.iter().map(u64::to_string).collect();
    Err(Failure::bad_input(format_args!(
        "`{}` takes {} argument(s), not {}",
        atom.name,
        wanted.join(" or "),
        atom.args.len()
    )))
}

/// Refuses a fact that a room takes no notice of. `names` are what there is in it.
fn the_room_takes_it(fact: &FactChange, atom: &Atom, names: &Value) -> Result<(), Failure> {
    let Some(about) = executor_sim::users_speak_about(fact) else {
        let what = format!("`{fact}` is not for users to say: vehicles find that out, or do it");
        return Err(Failure::bad_input(what).advice(
            "users may say: arrived, seated, gone, wants, spill, blocked, stands, used; and of a bottle what is not so any more",
        ));
    };
    for (arg, what) in atom.args.iter().zip(about) {
        // What is not listed is not checked.
        let Some(known) = names[*what].as_array() else {
            continue;
        };
        let known: Vec<&str> = known.iter().filter_map(Value::as_str).collect();
        if !known.contains(&arg.as_str()) {
            let what = match *what {
                "node" => "place",
                what => what,
            };
            let failure = Failure::bad_input(format_args!("there is no {what} `{arg}`"));
            return Err(match nearest(arg.as_str(), known.iter().copied()) {
                Some(near) => failure.advice(format_args!("did you mean `{near}`?")),
                None => failure.advice(format_args!("one of {}", known.join(", "))),
            });
        }
    }
    Ok(())
}

/// Opens or closes a door.
pub(crate) async fn door(args: DoorArgs) -> Result<Exit, Failure> {
    let connection = Connection::open(&args.target).await?;
    let result = set_door(&connection, &args).await;
    connection.close(result).await
}

async fn set_door(connection: &Connection, args: &DoorArgs) -> Result<Exit, Failure> {
    let client = &connection.client;
    let belief = match client.look(WORLD, View::Belief).await {
        Ok(belief) => belief,
        Err(error) => {
            let failure = unanswered_by(client, WORLD, error).await;
            return Err(
                failure.advice("doors are the business of a robot's world; a restaurant has none")
            );
        }
    };
    let doors = belief["doors"].as_object().cloned().unwrap_or_default();
    if !doors.contains_key(&args.door) {
        let names = doors.keys().map(String::as_str);
        let failure = Failure::bad_input(format_args!("there is no door `{}`", args.door));
        return Err(match nearest(&args.door, names) {
            Some(near) => failure.advice(near),
            None => {
                let names: Vec<&str> = doors.keys().map(String::as_str).collect();
                failure.advice(format_args!("one of {}", names.join(", ")))
            }
        });
    }
    let (fact, state) = match args.state {
        DoorState::Open => (format!("(open {})", args.door), "open"),
        DoorState::Closed => (format!("(not (open {}))", args.door), "closed"),
    };
    let verdict = client.facts(&fact).await.map_err(unanswered)?;
    Ok(tell(
        json!(verdict),
        verdict.accepted,
        verdict.reason.as_deref(),
        &format!("{} is {state}", args.door),
        args.json,
    ))
}

fn tell(verdict: Value, accepted: bool, reason: Option<&str>, words: &str, as_json: bool) -> Exit {
    if as_json {
        anstream::println!("{verdict}");
    } else if accepted {
        anstream::println!("{GOOD}ok{GOOD:#} {words}");
    } else {
        let reason = reason.unwrap_or("no reason given");
        anstream::eprintln!("{BAD}rejected:{BAD:#} {reason}");
    }
    if accepted { Exit::Done } else { Exit::Failed }
}
