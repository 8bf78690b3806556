//! Words of other languages in the names of columns, for the options that messages name.

use super::super::endings::bracketed;
use crate::recording::options::units::is_separator;

/// Parts of the names of positions, and of times, without accents.
pub(super) const POSITIONS: &[&str] = &["winkel", "angolo", "angulo", "hoek", "lage", "drehgeber"];
pub(super) const TIMES: &[&str] = &["zeit", "temps", "tiempo", "tempo", "tijd"];

/// Units of a position, and what they are called without accents. A German `Grad` is a degree; the
/// English `grad` is not, so the unit is a guess.
const UNITS: [(&str, &[&str]); 3] = [
    (
        "deg",
        &[
            "grad", "grado", "grados", "gradi", "graden", "grader", "graus", "degre", "degres",
        ],
    ),
    (
        "counts",
        &[
            "inkremente",
            "inkr",
            "impulse",
            "impulsions",
            "impulsos",
            "impulsi",
            "incrementos",
            "incrementi",
        ],
    ),
    (
        "rev",
        &[
            "tr",
            "tour",
            "tours",
            "umdrehung",
            "umdrehungen",
            "vuelta",
            "vueltas",
            "giro",
            "giri",
            "omwentelingen",
        ],
    ),
];

/// `name` in lower case without the accents of these words.
pub(super) fn plain(name: &str) -> String {
    let plain = |c: char| match c {
        'á' | 'à' | 'â' | 'ä' => Some('a'),
        'é' | 'è' | 'ê' | 'ë' => Some('e'),
        'í' | 'ì' | 'î' => Some('i'),
        'ó' | 'ò' | 'ô' | 'ö' => Some('o'),
        'ú' | 'ù' | 'û' | 'ü' => Some('u'),
        // An accent behind its letter.
        '\u{300}'..='\u{36f}' => None,
        other => Some(other),
    };
    name.to_lowercase().chars().filter_map(plain).collect()
}

/// The unit of a position that the end of `name` probably is.
pub(super) fn unit(name: &str) -> Option<&'static str> {
    let name = plain(name.trim());
    let end = match bracketed(&name) {
        Some((_, inside)) => inside,
        None => name.rsplit(is_separator).next().unwrap_or_default(),
    };
    let mut units = UNITS.iter().filter(|(_, names)| names.contains(&end));
    units.next().map(|(unit, _)| *unit)
}

#[cfg(test)]
mod tests {
    use super::unit;
    use crate::recording::read_log as read;

    #[test]
    fn end_of_a_name_is_a_unit_of_another_language() {
        for (name, expected) in [
            ("posicion_grados", Some("deg")),
            ("Position [Inkremente]", Some("counts")),
            ("angle_degres", Some("deg")),
            ("angle (degr\u{e9}s)", Some("deg")),
            ("angle (degre\u{301}s)", Some("deg")),
            ("Winkel in Grad", Some("deg")),
            ("angolo [gradi]", Some("deg")),
            ("hoek (graden)", Some("deg")),
            ("position (tr)", Some("rev")),
            ("position en tours", Some("rev")),
            ("Winkel [Umdrehungen]", Some("rev")),
            ("posicion_vueltas", Some("rev")),
            ("posizione (giri)", Some("rev")),
            ("vitesse_tr_min", None),
            ("Drehzahl [U/min]", None),
            ("velocidad (grados/s)", None),
            ("gradient", None),
        ] {
            assert_eq!(unit(name), expected, "{name}");
        }
    }

    #[test]
    fn example_in_another_language_is_read_as_it_stands() {
        for (header, option, guess) in [
            (
                "temps (ms);position (tr)",
                "t=temps (ms),counts_large=position (tr):rev",
                "rev",
            ),
            (
                "tiempo_ms;posicion_grados",
                "t=tiempo_ms,counts_large=posicion_grados:deg",
                "deg",
            ),
            (
                "Zeit in ms;Winkel in Grad",
                "t=Zeit in ms,counts_large=Winkel in Grad:deg",
                "deg",
            ),
            (
                "tempo [ms];\u{e1}ngulo [gradi]",
                "t=tempo [ms],counts_large=\u{e1}ngulo [gradi]:deg",
                "deg",
            ),
        ] {
            let text = format!("{header}\n0;0,25\n1;0,5\n2;0,75\n");
            let error = read(&text, "").unwrap_err();
            let said = format!("--column '{option}', where the unit {guess} is a guess; ");
            assert!(error.contains(&said), "{error}");
            read(&text, option).unwrap();
        }
    }
}
