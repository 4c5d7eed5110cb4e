//! One thing of the language, or of the search, in each.

use super::{Outcome, actions, compiled, depth_first, judged, plan};

/// A domain with these parts, whose task is `(do)`.
fn domain(parts: &str) -> String {
    format!(
        "(define (domain small) (:requirements :hierarchy :typing :adl)
        (:types place box - thing)
        (:predicates (at ?b - box ?p - place) (road ?p ?q - place) (open ?p - place)
          (seen ?t - thing) (ready) (spoilt))
        (:task do :parameters ())
        (:action move :parameters (?b - box ?p ?q - place)
          :precondition (and (at ?b ?p) (road ?p ?q))
          :effect (and (not (at ?b ?p)) (at ?b ?q)))
        (:action look :parameters (?t - thing) :precondition () :effect (seen ?t))
        (:action prepare :parameters () :precondition (not (ready)) :effect (ready))
        (:action spoil :parameters () :precondition () :effect (spoilt))
        {parts})"
    )
}

/// A problem whose objects are three places in a row and a box at the first.
fn problem(rest: &str) -> String {
    format!(
        "(define (problem one) (:domain small)
        (:objects p1 p2 p3 - place b1 - box)
        {rest})"
    )
}

const ROW: &str = "(:init (at b1 p1) (road p1 p2) (road p2 p1) (road p2 p3) (road p3 p2))";

#[test]
fn methods_are_tried_in_the_order_in_which_they_are_written() {
    let domain = domain(
        "(:method second :parameters () :task (do) :ordered-subtasks (and (spoil)))
         (:method first :parameters () :task (do) :ordered-subtasks (and (prepare)))",
    );
    let problem = problem(&format!("(:htn :ordered-subtasks (and (do))) {ROW}"));
    assert_eq!(actions(&plan(&domain, &problem)), ["spoil"]);
}

#[test]
fn a_later_method_is_taken_if_the_first_leads_nowhere() {
    let domain = domain(
        "(:method second :parameters () :task (do) :ordered-subtasks (and (spoil)))
         (:method first :parameters () :task (do) :ordered-subtasks (and (prepare)))",
    );
    let problem = problem(&format!(
        "(:htn :ordered-subtasks (and (do))) {ROW} (:goal (and (not (spoilt))))"
    ));
    assert_eq!(actions(&plan(&domain, &problem)), ["prepare"]);
}

#[test]
fn a_task_that_goes_on_for_ever_in_the_same_state_is_left() {
    let domain = domain(
        "(:method again :parameters (?p - place) :task (do) :precondition (open ?p)
           :ordered-subtasks (and (look ?p) (do)))
         (:method end :parameters () :task (do) :precondition (ready) :ordered-subtasks (and))
         (:method begin :parameters () :task (do) :ordered-subtasks (and (prepare) (do)))",
    );
    let problem = problem("(:htn :ordered-subtasks (and (do))) (:init (open p1))");
    assert_eq!(actions(&plan(&domain, &problem)), ["look p1", "prepare"]);
}

#[test]
fn a_task_list_that_would_grow_for_ever_is_left() {
    let domain = domain(
        "(:method more :parameters () :task (do) :ordered-subtasks (and (do) (spoil)))
         (:method end :parameters () :task (do) :ordered-subtasks (and))",
    );
    let problem = problem(&format!("(:htn :ordered-subtasks (and (do))) {ROW}"));
    assert_eq!(actions(&plan(&domain, &problem)), ["spoil"; 0]);
}

#[test]
fn a_task_within_itself_is_found_if_nothing_else_helps() {
    // Only `do` in `do` in the same state spoils before anything is prepared.
    let domain = domain(
        "(:method more :parameters () :task (do) :ordered-subtasks (and (do) (spoil)))
         (:method end :parameters () :task (do) :ordered-subtasks (and))",
    );
    let problem = problem(&format!(
        "(:htn :ordered-subtasks (and (do))) {ROW} (:goal (and (spoilt)))"
    ));
    assert_eq!(actions(&plan(&domain, &problem)), ["spoil"]);
}

#[test]
fn places_are_found_on_the_way_without_going_in_circles() {
    let domain = domain(
        "(:task bring :parameters (?b - box ?p - place))
         (:method step :parameters (?b - box ?p ?q ?r - place) :task (bring ?b ?p)
           :precondition (at ?b ?q)
           :ordered-subtasks (and (move ?b ?q ?r) (bring ?b ?p)))
         (:method there :parameters (?b - box ?p - place) :task (bring ?b ?p)
           :precondition (at ?b ?p) :ordered-subtasks (and))",
    );
    let problem = problem(&format!(
        "(:htn :ordered-subtasks (and (bring b1 p3))) {ROW}"
    ));
    assert_eq!(
        actions(&plan(&domain, &problem)),
        ["move b1 p1 p2", "move b1 p2 p3"]
    );
}

#[test]
fn a_way_is_found_from_its_end() {
    let domain = domain(
        "(:task bring :parameters (?b - box ?p - place))
         (:method via :parameters (?b - box ?p ?q - place) :task (bring ?b ?p)
           :ordered-subtasks (and (bring ?b ?q) (move ?b ?q ?p)))
         (:method there :parameters (?b - box ?p - place) :task (bring ?b ?p)
           :precondition (at ?b ?p) :ordered-subtasks (and))",
    );
    let problem = problem(&format!(
        "(:htn :ordered-subtasks (and (bring b1 p3))) {ROW}"
    ));
    assert_eq!(
        actions(&plan(&domain, &problem)),
        ["move b1 p1 p2", "move b1 p2 p3"]
    );
}

#[test]
fn negative_and_quantified_preconditions_are_looked_at() {
    let domain = domain(
        "(:method done :parameters () :task (do)
           :precondition (forall (?p - place) (seen ?p)) :ordered-subtasks (and))
         (:method next :parameters (?p - place) :task (do)
           :precondition (and (not (seen ?p)) (exists (?q - place) (road ?q ?p))
             (imply (ready) (open ?p)))
           :ordered-subtasks (and (look ?p) (do)))",
    );
    let problem = problem(&format!("(:htn :ordered-subtasks (and (do))) {ROW}"));
    assert_eq!(
        actions(&plan(&domain, &problem)),
        ["look p1", "look p2", "look p3"]
    );
}

#[test]
fn effects_depend_on_the_state_before_the_action() {
    let domain = domain(
        "(:action flip :parameters () :precondition ()
           :effect (forall (?p - place) (and
             (when (open ?p) (not (open ?p))) (when (not (open ?p)) (open ?p)))))
         (:method do_it :parameters () :task (do) :ordered-subtasks (and (flip)))",
    );
    let problem = problem(
        "(:htn :ordered-subtasks (and (do))) (:init (open p2))
         (:goal (and (open p1) (not (open p2)) (open p3)))",
    );
    assert_eq!(actions(&plan(&domain, &problem)), ["flip"]);
}

#[test]
fn objects_are_chosen_for_the_variables_of_the_problem() {
    let domain = domain("(:method do_it :parameters () :task (do) :ordered-subtasks (and))");
    let problem = problem(&format!(
        "(:htn :parameters (?p ?q - place) :ordered-subtasks (and (look ?p) (look ?q) (do))
           :constraints (not (= ?p ?q))) {ROW}
         (:goal (and (not (seen p1))))"
    ));
    assert_eq!(actions(&plan(&domain, &problem)), ["look p2", "look p3"]);
}

#[test]
fn a_variable_twice_in_the_head_of_a_method_is_one_object() {
    let domain = domain(
        "(:task link :parameters (?p ?q - place))
         (:method same :parameters (?p - place) :task (link ?p ?p) :ordered-subtasks (and (spoil)))
         (:method other :parameters (?p ?q - place) :task (link ?p ?q)
           :ordered-subtasks (and (look ?q)))",
    );
    let problem = problem(&format!(
        "(:htn :ordered-subtasks (and (link p1 p2) (link p3 p3))) {ROW}"
    ));
    assert_eq!(actions(&plan(&domain, &problem)), ["look p2", "spoil"]);
}

#[test]
fn what_has_no_plan_is_proved_to_have_none() {
    let domain = domain(
        "(:task bring :parameters (?b - box ?p - place))
         (:method step :parameters (?b - box ?p ?q ?r - place) :task (bring ?b ?p)
           :precondition (at ?b ?q)
           :ordered-subtasks (and (move ?b ?q ?r) (bring ?b ?p)))
         (:method there :parameters (?b - box ?p - place) :task (bring ?b ?p)
           :precondition (at ?b ?p) :ordered-subtasks (and))",
    );
    let problem = problem(
        "(:htn :ordered-subtasks (and (bring b1 p3)))
         (:init (at b1 p1) (road p1 p2) (road p2 p1))",
    );
    let compiled = compiled(&domain, &problem);
    assert_eq!(depth_first(&compiled, u64::MAX), Outcome::Unsolvable);
}

#[test]
fn tasks_a_million_deep_do_not_overflow() {
    // A counter of twenty bits that counts up once: each step is within the one before.
    let bits = 17;
    let mut domain = String::from(
        "(define (domain deep) (:requirements :hierarchy :typing :adl) (:types bit)
        (:predicates (on ?b - bit) (next ?b ?c - bit) (first ?b - bit))
        (:task count :parameters ())
        (:task carry :parameters (?b - bit))
        (:action set :parameters (?b - bit) :precondition (not (on ?b)) :effect (on ?b))
        (:action unset :parameters (?b - bit) :precondition (on ?b) :effect (not (on ?b)))
        (:method full :parameters () :task (count)
          :precondition (forall (?b - bit) (on ?b)) :ordered-subtasks (and))
        (:method up :parameters (?b - bit) :task (count) :precondition (first ?b)
          :ordered-subtasks (and (carry ?b) (count)))
        (:method stop :parameters (?b - bit) :task (carry ?b) :precondition (not (on ?b))
          :ordered-subtasks (and (set ?b)))
        (:method on :parameters (?b ?c - bit) :task (carry ?b)
          :precondition (and (on ?b) (next ?b ?c))
          :ordered-subtasks (and (unset ?b) (carry ?c)))",
    );
    domain.push(')');
    let mut init = String::from("(first b0)");
    let mut objects = String::from("b0");
    for bit in 1..bits {
        init += &format!(" (next b{} b{bit})", bit - 1);
        objects += &format!(" b{bit}");
    }
    let problem = format!(
        "(define (problem one) (:domain deep) (:objects {objects} - bit)
         (:htn :ordered-subtasks (and (count))) (:init {init}))"
    );
    let compiled = compiled(&domain, &problem);
    let Outcome::Found(choices) = depth_first(&compiled, u64::MAX) else {
        panic!("there is a plan");
    };
    let solution = crate::plan::Solution::new(&compiled, &choices).expect("choices make a plan");
    assert_eq!(solution.length(), (1 << (bits + 1)) - 2 - bits);
}

#[test]
fn the_same_problem_has_the_same_plan_each_time() {
    for seed in 0..20 {
        let (domain, problem) = super::random::problem(seed);
        let compiled = compiled(&domain, &problem);
        let again = super::compiled(&domain, &problem);
        assert_eq!(
            depth_first(&compiled, 1000),
            depth_first(&again, 1000),
            "seed {seed}"
        );
    }
}

#[test]
fn a_goal_that_no_later_task_can_help_cuts_the_search() {
    // Thirty tasks that each may spoil a place or not; the goal wants the first untouched.
    let mut domain = domain("(:task maybe :parameters (?p - place))");
    domain.pop();
    domain += "(:method look_at :parameters (?p - place) :task (maybe ?p)
          :ordered-subtasks (and (look ?p)))
        (:method leave :parameters (?p - place) :task (maybe ?p) :ordered-subtasks (and (nothing)))
        (:action nothing :parameters () :precondition () :effect ()))";
    let places: Vec<String> = (0..30).map(|place| format!("n{place}")).collect();
    let tasks: Vec<String> = places
        .iter()
        .map(|place| format!("(maybe {place})"))
        .collect();
    let goals: Vec<String> = places
        .iter()
        .map(|place| format!("(not (seen {place}))"))
        .collect();
    let problem = format!(
        "(define (problem one) (:domain small) (:objects {} - place)
         (:htn :ordered-subtasks (and {})) (:init) (:goal (and {})))",
        places.join(" "),
        tasks.join(" "),
        goals.join(" ")
    );
    let compiled = compiled(&domain, &problem);
    let outcome = depth_first(&compiled, 100);
    let plan = judged(&domain, &problem, &compiled, &outcome);
    assert_eq!(actions(&plan).len(), 30);
}

#[test]
fn what_a_later_step_needs_is_not_used_up_before() {
    // Whatever is opened stays open, and `close_up` needs the place shut; only the last of many
    // choices leaves it so, for each of thirty tasks.
    let mut domain = domain("(:task maybe :parameters (?p - place))");
    domain.pop();
    domain += "(:action open_up :parameters (?p - place) :precondition () :effect (open ?p))
        (:action close_up :parameters (?p - place) :precondition (not (open ?p))
          :effect (seen ?p))
        (:method any :parameters (?p - place) :task (maybe ?p) :ordered-subtasks (and (open_up ?p)))
        (:method none :parameters (?p - place) :task (maybe ?p) :ordered-subtasks (and)))";
    let places: Vec<String> = (0..30).map(|place| format!("n{place}")).collect();
    let tasks = |name: &str| -> String {
        places
            .iter()
            .map(|place| format!("({name} {place})"))
            .collect()
    };
    let problem = format!(
        "(define (problem one) (:domain small) (:objects {} - place)
         (:htn :ordered-subtasks (and {} {})) (:init))",
        places.join(" "),
        tasks("maybe"),
        tasks("close_up")
    );
    let compiled = compiled(&domain, &problem);
    let outcome = depth_first(&compiled, 100);
    let plan = judged(&domain, &problem, &compiled, &outcome);
    assert_eq!(actions(&plan).len(), 30);
}
