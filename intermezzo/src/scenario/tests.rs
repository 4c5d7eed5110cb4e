use super::*;
use agent_core::protocol::Urgency;
use maps::Place;

fn read(text: &str) -> Result<Scenario, Vec<String>> {
    Scenario::from_text("story.toml", text, Place::museum().site())
        .map_err(|findings| findings.iter().map(ToString::to_string).collect())
}

#[test]
fn a_story_is_read_in_its_order_and_every_goal_has_a_name() {
    let story = read(
        r#"
        [[event]]
        goal = "(guide n40)"
        [[event]]
        while_on = "arc5"
        say = "In need!"
        emergency = "(go n28)"
        id = "toilet"
        priority = 2
        deadline_s = 60
        [[event]]
        at_s = 40.5
        door = "door4_6"
        state = "closed"
        [[event]]
        cancel = "toilet"
        "#,
    )
    .unwrap();
    let names: Vec<&str> = story.goals().map(GoalId::as_str).collect();
    assert_eq!(names, ["goal1", "toilet"]);
    assert_eq!(story.events[1].when, When::WhileOn("arc5".into()));
    let Some(What::Goal {
        request: toilet,
        to: None,
    }) = &story.events[1].what
    else {
        unreachable!("the second event is a goal");
    };
    assert_eq!((toilet.urgency, toilet.priority), (Urgency::Emergency, 2));
    assert_eq!(story.events[2].when, When::At(Time::from_secs(40.5)));
    let closed = FactChange::Remove(agent_core::model::Atom::new("open", ["door4_6"]));
    assert_eq!(story.events[2].what, Some(What::Fact(closed)));
}

#[test]
fn all_faults_are_named_each_with_its_line() {
    let faults = read(
        r#"[[event]]
gaol = "(go n1)"
[[event]]
goal = "go n1"
while_on = "arc99"
[[event]]
door = "door99"
state = "ajar"
[[event]]
at_s = "soon"
suspend = "nobody"
[[event]]
at_s = 1
[[event]]
goal = "(go n1)"
emergency = "(go n2)"
[[event]]
say = "x"
priority = 1.5
"#,
    )
    .unwrap_err();
    let faults = faults.join("\n");
    for words in [
        "story.toml:2: `gaol` is unknown: did you mean `goal`?",
        "story.toml:4: ",
        "story.toml:5: there is no arc `arc99`",
        "story.toml:7: there is no door `door99`",
        "story.toml:8: `state` is",
        "story.toml:10: `at_s` is a number",
        "story.toml:11: there is no goal `nobody`",
        "story.toml:12: nothing happens",
        "story.toml:14: an event does one thing, not goal and emergency",
        "story.toml:19: `priority` stands without a goal",
    ] {
        assert!(faults.contains(words), "{words} is not in\n{faults}");
    }
}

#[test]
fn what_is_not_toml_is_named_with_its_line_too() {
    let faults = read("[[event]]\ngoal = (go n1)\n").unwrap_err();
    assert!(faults[0].starts_with("story.toml:2: "), "{faults:?}");
    let faults = read("").unwrap_err();
    assert_eq!(faults, ["story.toml:1: there is no [[event]]"]);
}

#[test]
fn the_built_in_story_is_in_order() {
    assert!(read(crate::command::demo::STORY).is_ok());
}

#[test]
fn a_story_of_a_team_waits_for_what_its_vehicles_do_and_learn() {
    let story = read(
        r#"
        [[event]]
        while_doing = "k3 put-on-tray"
        emergency = "(clean table3)"
        to = "k3"
        [[event]]
        once = "(served ann cola)"
        say = "Cheers."
        "#,
    )
    .unwrap();
    let [spill, cheers] = story.events.as_slice() else {
        unreachable!("two events");
    };
    let doing = When::WhileDoing {
        agent: "k3".into(),
        action: "put-on-tray".into(),
    };
    assert_eq!(spill.when, doing);
    let Some(What::Goal { to: Some(to), .. }) = &spill.what else {
        unreachable!("the first event is a goal for somebody");
    };
    assert_eq!(to, "k3");
    let served = agent_core::model::Atom::new("served", ["ann", "cola"]);
    assert_eq!(cheers.when, When::Once(served));
}

#[test]
fn one_thing_is_waited_for_at_a_time() {
    let faults = read(
        r#"[[event]]
at_s = 1
once = "(served ann cola)"
say = "?"
[[event]]
while_doing = "k3"
say = "?"
[[event]]
once = "(not (served ann cola))"
say = "?"
"#,
    );
    let faults = faults.unwrap_err();
    assert_eq!(faults.len(), 3, "{faults:?}");
    assert!(faults[0].contains("one of `at_s`"), "{}", faults[0]);
    assert!(
        faults[1].contains("an agent and an action"),
        "{}",
        faults[1]
    );
}
