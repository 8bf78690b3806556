//! Names, lists and random draws of the scenarios.

use super::*;

#[test]
fn names_are_parsed_and_an_unknown_one_lists_them() {
    for name in ScenarioName::ALL {
        assert_eq!(name.to_string().parse(), Ok(name));
    }
    let error = "free_air".parse::<ScenarioName>().unwrap_err();
    assert!(
        error.contains("'free_air'; did you mean free-air?") && error.contains("step, permanent")
    );
}

#[test]
fn lists_of_scenarios_are_those_of_their_purpose() {
    let names = |list: Vec<ScenarioName>| {
        let names = list.into_iter().map(ScenarioName::as_str);
        names.collect::<Vec<_>>().join(" ")
    };
    let with_friction = names(ScenarioName::with_friction());
    assert!(
        with_friction.starts_with("step permanent track "),
        "{with_friction}"
    );
    assert_eq!(
        names(ScenarioName::compared()),
        format!("{with_friction} stochastic")
    );
    assert_eq!(names(ScenarioName::of(&[Role::Warming])), "heating");
    for scenario in ScenarioName::ALL {
        let least = if scenario == ScenarioName::Heating {
            60.0
        } else {
            10.0
        };
        assert_eq!(scenario.default_seconds(), least, "{scenario}");
        assert!(scenario.description().len() > 20, "{scenario}");
    }
}

/// No loop of theirs tracks a slip.
#[test]
fn scenarios_without_a_loop_on_the_reference_do_not_simulate_it() {
    let without = ScenarioName::ALL
        .into_iter()
        .filter(|name| !name.reads_reference());
    let without: Vec<_> = without.map(ScenarioName::as_str).collect();
    assert!(
        without.contains(&"step") && without.contains(&"stochastic"),
        "{without:?}"
    );
    assert!(!without.contains(&"permanent"), "{without:?}");
}

#[test]
fn draws_differ_between_scenarios_and_seeds() {
    let mut seeds: Vec<u64> = ScenarioName::ALL
        .iter()
        .flat_map(|name| (0..100).map(|seed| name.mix(seed)))
        .collect();
    seeds.sort_unstable();
    seeds.dedup();
    assert_eq!(seeds.len(), 100 * ScenarioName::ALL.len());
}
