//! What is typed wrongly is answered with what, where and what to do.

use crate::harness::User;

#[tokio::test(flavor = "multi_thread")]
async fn without_a_robot_every_command_says_how_to_start_one() {
    let user = User::new().await;
    for command in [
        &["status"][..],
        &["goal", "(go n4)"],
        &["watch"],
        &["suspend", "x"],
        &["fact", "(open door3_5)"],
        &["door", "door3_5", "closed"],
    ] {
        let said = user.run(command).await;
        assert_eq!(said.code, Some(3), "{command:?}: {said:?}");
        assert!(said.err.contains("intermezzo up"), "{command:?}: {said:?}");
        assert_eq!(said.out, "");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn bad_input_is_named() {
    let user = User::new().await;
    let dir = user.path();
    let story = dir.join("bad.toml");
    std::fs::write(
        &story,
        "[[event]]\ngaol = 1\n[[event]]\nwhile_on = \"arc99\"\nsay = \"x\"\n",
    )
    .unwrap();
    let map = dir.join("bad.geojson");
    std::fs::write(&map, "{}").unwrap();
    let (story, map) = (story.to_str().unwrap(), map.to_str().unwrap());
    for (command, code, words) in [
        (&["goal", "go n4"][..], 2, "is not a task"),
        (&["goal", "(go n4)", "--id", "two words"], 2, "one word"),
        (&["goal", "(go n4)", "--deadline", "-1"], 2, "deadline"),
        (&["fact", "open"], 2, "is not a fact"),
        (&["frobnicate"], 2, "frobnicate"),
        (
            &["up", "/no/such/place"],
            2,
            "there is no folder /no/such/place",
        ),
        (&["up", "--start", "n99"], 2, "n99"),
        (&["up", "--speed", "0"], 2, "above zero"),
        (&["up", "--robot", "a/b"], 2, "cannot be a name"),
        (&["up", "--scenario", story], 2, "bad.toml:2: `gaol`"),
        (
            &["up", "--scenario", story],
            2,
            "bad.toml:4: there is no arc",
        ),
        (&["map", "check", "/no/map"], 2, "there is no file"),
        (&["map", "check", map], 1, "bad.geojson: is not GeoJSON"),
        (&["domain", "check", "/no/dir"], 2, "there is no folder"),
    ] {
        let said = user.run(command).await;
        assert_eq!(said.code, Some(code), "{command:?}: {said:?}");
        let all = format!("{}{}", said.out, said.err);
        assert!(all.contains(words), "{command:?}: {said:?}");
    }
    let museum = concat!(env!("CARGO_MANIFEST_DIR"), "/../maps/museum");
    let said = user
        .ok(&["map", "check", &format!("{museum}/map.geojson")])
        .await;
    assert!(said.out.contains("40 nodes"), "{said:?}");
    user.ok(&["domain", "check", museum]).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_museum_of_any_size_is_a_map_or_a_place_like_any_other() {
    let user = User::new().await;
    let map = user.path().join("made_up.geojson");
    let map = map.to_str().unwrap();
    let said = user
        .ok(&["map", "scale", "--nodes", "400", "--seed", "7", "-o", map])
        .await;
    assert!(said.out.contains("80 areas, 400 nodes"), "{said:?}");
    let checked = user.ok(&["map", "check", map]).await;
    assert!(checked.out.contains("in order"), "{checked:?}");
    let printed = user
        .ok(&["map", "scale", "--nodes", "400", "--seed", "7"])
        .await;
    assert_eq!(printed.out, std::fs::read_to_string(map).unwrap());

    let place = user.path().join("large/");
    let place = place.to_str().unwrap();
    user.ok(&["map", "scale", "--nodes", "80", "-o", place])
        .await;
    user.ok(&["domain", "check", place]).await;
    let said = user.run(&["map", "scale", "--nodes", "0"]).await;
    assert_eq!(said.code, Some(2), "{said:?}");
}
