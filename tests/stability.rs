//! The cases of `experiment stability` that do not depend on the clock, with few enough tries to
//! take seconds.

use afterimage::experiment::stability::{Trial, cases};
use std::collections::HashSet;

#[test]
fn every_case_holds_or_states_its_limit() {
    let mut wrong = Vec::new();
    for case in cases().filter(|case| !case.is_timed) {
        let measured = case.run(&Trial::QUICK).unwrap();
        if !case.holds(measured.value) && case.known_limit.is_empty() {
            let (value, bound, note) = (measured.value, case.bound, measured.note);
            wrong.push(format!("{}: {value} {}, at most {bound}; {note}", case.name, case.expected));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_catalogue_is_complete() {
    let names: Vec<&str> = cases().map(|case| case.name).collect();
    assert!(names.len() >= 60, "{} cases", names.len());
    assert_eq!(names.iter().collect::<HashSet<_>>().len(), names.len(), "two cases have the same name");
    for (letter, last) in
        [('A', 6), ('B', 12), ('C', 10), ('D', 16), ('E', 11), ('H', 6), ('J', 10), ('K', 2)]
    {
        let rows: HashSet<&str> = names.iter().filter_map(|name| name.split(' ').next()).collect();
        for row in 1..=last {
            assert!(rows.contains(format!("{letter}{row}").as_str()), "{letter}{row} is missing");
        }
    }
}
