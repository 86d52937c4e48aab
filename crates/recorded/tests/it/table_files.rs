//! Reads the same contacts from the file formats of other programs. The estimates must be equal. If a message proposes
//! a setting, the file must be readable with this setting.

use palpate_recorded::{
    Form, GlideOptions, GlideRecording, RecordedFile, TipReports, column_names, estimate_glide,
};
use serde_json::Value;

const BALL: &str = include_str!("../data/glide-ball25.csv");

fn glide(contents: impl AsRef<[u8]>, columns: &str) -> Result<Value, String> {
    let mut form = Form::default();
    if !columns.is_empty() {
        form.columns = column_names(columns).unwrap();
    }
    let mut file = RecordedFile::new("r", contents.as_ref().to_vec());
    file.form = form;
    let readings = GlideRecording::try_from(file).map_err(|error| error.to_string())?;
    let estimate = estimate_glide(&readings, &GlideOptions::default());
    let (estimate, _) = estimate.map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(estimate).unwrap())
}

fn mean(estimate: &Value) -> f64 {
    estimate["mean_curvature"]["value"].as_f64().unwrap()
}

/// The value that an error message proposes for a setting.
#[track_caller]
pub(crate) fn hint(message: &str) -> &str {
    let rest = message.split_once("setting `columns` '");
    let (_, rest) = rest.unwrap_or_else(|| panic!("{message}"));
    rest.split_once('\'').unwrap().0
}

/// Contacts on a ball, as rows of numbers: finger, position, normal.
fn rows() -> Vec<Vec<f64>> {
    let row = |line: &str| {
        line.split(',')
            .map(|field| field.parse().unwrap())
            .collect()
    };
    BALL.lines().skip(1).map(row).collect()
}

/// A table of the contacts on the ball. `columns` selects columns of [`rows`].
fn table(header: &str, delimiter: &str, columns: &[usize]) -> String {
    let row = |row: &Vec<f64>| {
        let fields: Vec<String> = columns.iter().map(|&at| row[at].to_string()).collect();
        fields.join(delimiter) + "\n"
    };
    format!("{header}{}", rows().iter().map(row).collect::<String>())
}

const ALL: [usize; 7] = [0, 1, 2, 3, 4, 5, 6];

#[test]
fn files_of_other_programs_hold_the_same_contacts() {
    let expected = glide(BALL, "").unwrap();
    assert!((mean(&expected) - 0.04).abs() < 0.002);
    let objects = |between: &str| {
        let rows = rows().into_iter().map(|row| {
            let [finger, x, y, z, nx, ny, nz] = row[..] else { panic!() };
            format!("{{\"finger\":{finger},\"x_mm\":{x},\"y_mm\":{y},\"z_mm\":{z},\"normal_x\":{nx},\"normal_y\":{ny},\"normal_z\":{nz}}}")
        });
        rows.collect::<Vec<_>>().join(between)
    };
    let columns = |dictionary: bool| {
        let column = |(at, name): (usize, &str)| {
            let values = rows()
                .into_iter()
                .enumerate()
                .map(|(row, fields)| match dictionary {
                    true => format!("\"{row:03}.5\":{}", fields[at]),
                    false => fields[at].to_string(),
                });
            let values = values.collect::<Vec<_>>().join(",");
            match dictionary {
                true => format!("\"{name}\": {{{values}}}"),
                false => format!("\"{name}\": [{values}]"),
            }
        };
        let names = BALL.lines().next().unwrap().split(',');
        let columns: Vec<String> = names.enumerate().map(column).collect();
        format!("{{\n{}\n}}", columns.join(",\n"))
    };
    let names = BALL.lines().next().unwrap().replace(',', "\",\"");
    let list = table("", ",", &ALL).trim_end().replace('\n', "],[");
    let vectors = |at: [usize; 3]| {
        let vector = |row: Vec<f64>| at.map(|at| row[at].to_string()).join(",");
        let vectors: Vec<String> = rows().into_iter().map(vector).collect();
        format!("[[{}]]", vectors.join("],["))
    };
    let fingers: Vec<String> = rows().iter().map(|row| row[0].to_string()).collect();
    let vectors = format!(
        "{{\"finger\":[{}],\"position\":{},\"normal\":{},\"rate\":100}}",
        fingers.join(","),
        vectors([1, 2, 3]),
        vectors([4, 5, 6])
    );
    let numbered = objects("\n");
    let numbered = numbered.lines().enumerate();
    let numbered: Vec<String> = numbered
        .map(|(row, text)| format!("\"{row}\":{text}"))
        .collect();
    for contents in [
        format!("{{\"columns\":[\"{names}\"],\"index\":[],\"data\":[[{list}]]}}"),
        format!("{{\"schema\":{{}},\"data\":[{}]}}", objects(",")),
        format!("{{{}}}", numbered.join(",")),
        table(
            "# finger x_mm y_mm z_mm normal_x normal_y normal_z\n",
            " ",
            &ALL,
        ),
        table(
            "# finger, x_mm, y_mm, z_mm, normal_x, normal_y, normal_z\n",
            "  ",
            &ALL,
        ),
        format!("{{\"rate\":100,\"contacts\":[{}]}}", objects(",")),
        format!("[{}]", objects(",")),
        objects("\n"),
        objects(" "),
        columns(false),
        columns(true),
        columns(true).replace("\"0", "\"2026-01-01T00:00:0"),
    ] {
        let found = glide(&contents, "").unwrap_or_else(|error| panic!("{error}: {contents}"));
        assert_eq!(found, expected, "{contents}");
    }
    let settings_first = format!("{{\"rate\":100}}\n{}", objects("\n"));
    let found = glide(&settings_first, "").unwrap();
    assert_eq!(found["mean_curvature"], expected["mean_curvature"]);
    let vector = |lost: &str| {
        let place = vectors.find("[[").unwrap() + 1;
        let end = vectors[place..].find(']').unwrap();
        format!("{}{lost}{}", &vectors[..place], &vectors[place + end + 1..])
    };
    for lost in ["NaN", "null", "[null,null,null]"] {
        let lost = vector(lost);
        let found = glide(&lost, hint(&glide(&lost, "").unwrap_err())).unwrap();
        assert_eq!(found["contacts"], 29, "{lost}");
    }
    for lost in ["NaN", "-Infinity"] {
        let of_python = columns(false).replacen(&rows()[4][1].to_string(), lost, 1);
        assert_eq!(glide(&of_python, "").unwrap()["contacts"], 29);
    }
    // The columns of these arrays have no unit, and are in an unusual order or have names of two words. The file must
    // be readable with the setting that the message proposes.
    let hinted = |contents: &[u8]| {
        let error = glide(contents, "").unwrap_err();
        glide(contents, hint(&error)).unwrap()
    };
    for contents in [
        &include_bytes!("../data/glide-ball25.npz")[..],
        include_bytes!("../data/glide-record-array.npy"),
        vectors.as_bytes(),
    ] {
        let found = hinted(contents);
        assert_eq!(
            found["mean_curvature"]["value"],
            expected["mean_curvature"]["value"]
        );
        assert_eq!(
            (&found["with_normals"], &found["fingers"]),
            (&true.into(), &3.into())
        );
    }
    let positions = table("", ",", &ALL[1..4]);
    for (row, columns) in [
        ("T.5,R", "x=1,y=2,z=3"),
        ("R,-1,0,0,0.5", "x=0,y=1,z=2"),
        ("7,T,base,R,0.5,1", "x=3,y=4,z=5"),
        ("7,T,,R", "x=3,y=4,z=5"),
    ] {
        let rows = positions.lines().zip(0..);
        let rows =
            rows.map(|(place, time)| row.replace('R', place).replace('T', &format!("{time}")));
        let text = rows.collect::<Vec<_>>().join("\n");
        assert_eq!(hint(&glide(&text, "").unwrap_err()), columns, "{row}");
        assert_eq!(hinted(text.as_bytes())["contacts"], 30, "{row}");
    }
    // Numbered rows of R, matrices of 4 x 4 numbers in one field or in 16 columns, and unusual headers.
    let expected_place = glide(table("x,y,z\n", ",", &ALL[1..4]), "").unwrap();
    for (header, row) in [
        ("\"x\" \"y\" \"z\"\n", "\"T\" X Y Z"),
        ("t;O_T_EE\n", "T;[1,0,0,0,0,1,0,0,0,0,1,0,X,Y,Z,1]"),
        ("", "1,0,0,X,0,1,0,Y,0,0,1,Z,0,0,0,1"),
        // These headers begin like XML and like a PLY cloud.
        ("<x>,<y>,<z>\n", "X,Y,Z"),
        ("ply,x,y,z\n", "T,X,Y,Z"),
    ] {
        let rows = rows().into_iter().zip(1..).map(|(place, time)| {
            let row = row.replace('T', &format!("{time}"));
            let row = row.replace('X', &place[1].to_string());
            let row = row.replace('Y', &place[2].to_string());
            row.replace('Z', &place[3].to_string()) + "\n"
        });
        let found = glide(header.to_owned() + &rows.collect::<String>(), "").unwrap();
        assert_eq!(mean(&found), mean(&expected_place), "{row}");
    }
    let found = hinted(table("", ",", &ALL).as_bytes());
    assert_eq!(
        (mean(&found), &found["fingers"]),
        (mean(&expected), &3.into())
    );
}

#[test]
fn files_of_the_field_give_their_answers() {
    let array = glide(include_bytes!("../data/glide-array.npy"), "").unwrap();
    assert!((mean(&array) - 0.04).abs() < 0.004, "{array}");
    let said = array["warnings"].to_string();
    assert!(
        said.contains("the columns have no names; they are read as x,y,z"),
        "{said}"
    );
    let saved = glide(include_str!("../data/glide-savetxt-header.csv"), "").unwrap();
    assert!((mean(&saved) - 0.04).abs() < 0.004, "{saved}");
    let ros = include_str!("../data/glide-rostopic-echo.csv");
    let log = glide(ros, "").unwrap();
    assert_eq!(
        (&log["length_unit"], &log["with_normals"]),
        (&"m".into(), &true.into())
    );
    assert!((mean(&log) - 40.0).abs() < 2.0, "{log}");
    // The warning states the setting `columns` that reads the same columns as the automatic choice.
    let said = log["warnings"].as_array().unwrap().iter();
    let said = said.map(|one| one["text"].as_str().unwrap());
    let said = said
        .into_iter()
        .find(|text| text.contains("`columns`"))
        .unwrap();
    assert_eq!(
        glide(ros, hint(said)).unwrap()["mean_curvature"],
        log["mean_curvature"]
    );
    let optional = table("x_mm,y_mm,z_mm,nx,ny,nz\n", ",", &ALL[1..]);
    let found = glide(&optional, "").unwrap();
    let said = found["warnings"].to_string();
    assert_eq!(hint(&said), "normal_x=nx,normal_y=ny,normal_z=nz");
    assert_eq!(glide(&optional, hint(&said)).unwrap()["with_normals"], true);
}

/// The proposed columns are positions and normals, and never other quantities along the same axes.
#[test]
fn columns_are_proposed_by_their_quantity() {
    let contacts = |place: &str| format!("x={place}x,y={place}y,z={place}z");
    for (header, place, more) in [
        (
            "contact.normal.x,contact.normal.y,contact.normal.z,contact.position.x,contact.position.y,contact.position.z",
            "contact.position.",
            ",normal_x=contact.normal.x,normal_y=contact.normal.y,normal_z=contact.normal.z",
        ),
        ("vel_x,vel_y,vel_z,pos_x,pos_y,pos_z", "pos_", ""),
        ("f_x,f_y,f_z,p_x,p_y,p_z", "p_", ""),
        ("fx,fy,fz,tx,ty,tz,px,py,pz", "p", ""),
        ("tx,ty,tz,qx,qy,qz,qw", "t", ""),
        ("cmd_x,cmd_y,cmd_z,tip_x,tip_y,tip_z", "tip_", ""),
        (
            "n_x,n_y,n_z,c_x,c_y,c_z",
            "c_",
            ",normal_x=n_x,normal_y=n_y,normal_z=n_z",
        ),
    ] {
        let row = header.split(',').map(|_| "1").collect::<Vec<_>>();
        let error = glide(format!("{header}\n{}\n", row.join(",")), "").unwrap_err();
        assert_eq!(hint(&error), contacts(place) + more, "{header}");
    }
    let two = "old_tip_x,old_tip_y,old_tip_z,new_tip_x,new_tip_y,new_tip_z\n1,1,1,2,2,2\n";
    let error = glide(two, "").unwrap_err();
    let both =
        ["old_tip_", "new_tip_"].map(|place| format!("setting `columns` '{}'", contacts(place)));
    assert!(error.ends_with(&both.join(" or ")), "{error}");
    // A row of numbers is no header, also if the setting `columns` is given.
    let error = glide("a,b,c\n1,2,3\n", "x=a,y=b").unwrap_err();
    assert!(!error.contains("names columns"), "{error}");
}

/// The radius of a tip is a single number beside the arrays, or a column with a unit.
#[test]
fn poses_of_tips_need_their_radius() {
    let poses = include_bytes!("../data/glide-tip-poses.npz");
    let columns = hint(&glide(poses, "").unwrap_err()).to_owned();
    let error = glide(poses, &columns).unwrap_err();
    assert!(
        error.contains("state setting `tip_radius` 5 for tips"),
        "{error}"
    );
    let form = Form {
        columns: column_names(&columns).unwrap(),
        ..Form::default()
    };
    let mut file = RecordedFile::new("r", poses.to_vec());
    file.form = form;
    let options = GlideOptions {
        tip_radius: Some(5.0),
        reports: Some(TipReports::Centre),
        ..GlideOptions::default()
    };
    let (estimate, _) = estimate_glide(&GlideRecording::try_from(file).unwrap(), &options).unwrap();
    let estimate = serde_json::to_value(estimate).unwrap();
    assert!((mean(&estimate) - 0.04).abs() < 0.001, "{estimate}");
    let named = table("tip_x,tip_y,tip_z\n", ",", &ALL[1..4]);
    let found = glide(&named, hint(&glide(&named, "").unwrap_err())).unwrap();
    let said = found["warnings"].to_string();
    assert!(said.contains("(`tip_x`) are read as contacts"), "{said}");
    let error = glide("x_mm,y_mm,z_mm,tip_radius_m\n1,2,3,0.005\n", "").unwrap_err();
    assert!(
        error.contains("state setting `tip_radius` 5 for tips"),
        "{error}"
    );
    // A file may state the tip's radius beside the list of contacts. Rows with lost readings may lack the radius. Radii
    // with other names, such as `object_radius`, are not radii of tips.
    let list = r#"{"tip":{"radius_mm":4},"contacts":[{"x_mm":1,"y_mm":2,"z_mm":3},{"x_mm":1,"y_mm":3,"z_mm":3}]}"#;
    let error = glide(list, "").unwrap_err();
    assert!(error.contains("4 mm in column `tip.radius_mm`"), "{error}");
    let two = list.replace("\"tip\"", "\"log\":[{\"a\":1},{\"a\":2}],\"tip\"");
    let error = glide(two, "").unwrap_err();
    assert!(
        error.contains("several lists of objects (`log`, `contacts`)"),
        "{error}"
    );
    for rows in [
        "tip_radius\n1,2,3,5\n1,3,3,5.0\n1,4,3,\n",
        "Tip Radius-mm\n1,2,3,5\n1,3,3,nan\n",
        "tip_dia\n1,2,3,10\n1,3,3,10\n",
        "r_tip\n1,2,3,5\n1,3,3,5\n",
    ] {
        let error = glide(format!("x,y,z,{rows}"), "").unwrap_err();
        assert!(
            error.contains("state setting `tip_radius` 5 for tips"),
            "{error}"
        );
    }
    let error = glide("x,y,z,object_radius\n1,2,3,5\n1,3,3,5\n", "").unwrap_err();
    assert!(!error.contains("tip_radius"), "{error}");
    let error = glide("x,y,z,tip_radius\n1,2,3,5\n1,3,3,6\n", "").unwrap_err();
    assert!(
        error.contains("the radius of tips is 5 in column"),
        "{error}"
    );
}

/// Each row of the table is for one time. It contains the columns of three fingers side by side.
#[test]
fn wide_tables_hold_several_fingers() {
    let expected = glide(BALL, "").unwrap();
    let rows = rows();
    let wide = |header: &str, columns: &[usize]| {
        let row = |time: usize| {
            let places = (0..3).flat_map(|finger| columns.iter().map(move |&at| (finger, at)));
            let fields = places.map(|(finger, at)| rows[10 * finger + time][at].to_string());
            format!("{time},{}\n", fields.collect::<Vec<_>>().join(","))
        };
        format!("{header}\n{}", (0..10).map(row).collect::<String>())
    };
    // Builds the names of all columns from the pattern `name`: `C` is replaced by the column, then `F` by the finger.
    let repeated = |name: &str, fingers: [&str; 3], columns: &[&str]| {
        let of_finger = |finger: &str| -> Vec<String> {
            let name = |column| name.replace('C', column).replace('F', finger);
            columns.iter().map(|column| name(column)).collect()
        };
        format!("time_s,{}", fingers.map(of_finger).concat().join(","))
    };
    let full = ["x_mm", "y_mm", "z_mm", "normal_x", "normal_y", "normal_z"];
    let letters = ["x", "y", "z", "nx", "ny", "nz"];
    let numbers = ["1", "2", "3"];
    let inner = [
        "x_F_mm",
        "y_F_mm",
        "z_F_mm",
        "normal_F_x",
        "normal_F_y",
        "normal_F_z",
    ];
    let contact = [
        "contact_F_x_mm",
        "contact_F_y_mm",
        "contact_F_z_mm",
        inner[3],
        inner[4],
        inner[5],
    ];
    for header in [
        repeated("F_C", ["finger1", "finger2", "finger3"], &full),
        repeated("F.C", ["thumb", "index", "ring"], &full),
        repeated("CF", numbers, &letters),
        repeated("C_F", ["f0", "f1", "f2"], &full),
        repeated("F/pose/pos/C", ["th_tip", "ff_tip", "mf_tip"], &full),
        repeated("FC", ["p1", "p2", "p3"], &letters),
        repeated("C", numbers, &inner),
        repeated("left_index_tip_F_C", numbers, &full),
        repeated("/hand/F/tip/C", ["thumb", "index", "middle"], &letters),
        repeated("C", numbers, &contact),
        repeated("F_C", ["left", "center", "right"], &full),
        repeated(
            "F_C",
            ["contact_left", "contact_mid", "contact_right"],
            &full,
        ),
        repeated("f_F_C", ["thumb", "first", "middle"], &full),
        repeated("F_C", ["a", "b", "c"], &full),
        repeated("F C", ["L", "M", "R"], &letters),
        repeated("CF", ["", "_2", "_3"], &letters),
        repeated("CF", ["", "2", "3"], &letters),
        repeated("CF", ["", ".1", ".2"], &full),
    ] {
        let found =
            glide(wide(&header, &ALL[1..]), "").unwrap_or_else(|error| panic!("{error}: {header}"));
        assert!((mean(&found) - mean(&expected)).abs() < 1e-12, "{header}");
        assert_eq!(
            (&found["fingers"], &found["contacts"]),
            (&3.into(), &30.into())
        );
    }
    // The names of the fingers are in the line above the names of the axes.
    let groups = "\"t\",thumb,,,index,,,ring,,\ns,x,y,z,x,y,z,x,y,z";
    assert_eq!(glide(wide(groups, &ALL[1..4]), "").unwrap()["fingers"], 3);
    let header = repeated("F_C", ["f1", "f2", "f3"], &letters[..3]);
    let table = wide(&header, &ALL[1..4]);
    let first: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    let lost = table.replacen(&first[4..7].join(","), "1,NaN,1", 1);
    let found = glide(&lost, "").unwrap();
    assert_eq!(found["contacts"], 29);
    let said = found["warnings"].to_string();
    assert!(
        said.contains("1 of 30 readings are left out") && said.contains("`f_2` in row 1, line 2"),
        "{said}"
    );
    let wrong = table.replacen(first[5], "east", 1);
    assert_eq!(
        glide(wrong, "").unwrap_err(),
        "r:2: column `f2_y`: `east` is not a number; leave the field empty if its number is missing"
    );
    // A log of ROS messages that each contain the poses of several fingers, in metres.
    let header = repeated("field.posesF.position.C", ["0", "1", "2"], &letters[..3]);
    let log = wide(&header.replace("time_s", "%time"), &ALL[1..4]);
    let found = glide(&log, "").unwrap();
    assert_eq!(
        (&found["fingers"], &found["length_unit"]),
        (&3.into(), &"m".into())
    );
    let short = table.replacen(&format!(",{}", first[9]), "", 1);
    assert_eq!(
        glide(short, "").unwrap_err(),
        "r:2: 9 fields; the header has 10"
    );
    // These columns are a commanded and a measured position of one finger, which must not be read as two fingers.
    let header = repeated("F_C", ["set", "real", "x"], &letters[..3]);
    let error = glide(wide(&header, &ALL[1..4]), "").unwrap_err();
    assert!(error.contains("no columns `x`"), "{error}");
    // The proposed setting reads fingers with unknown names.
    let header = repeated("F_C", ["daumen", "zeigefinger", "ring"], &full);
    let table = wide(&header, &ALL[1..]);
    let found = glide(&table, hint(&glide(&table, "").unwrap_err())).unwrap();
    assert!((mean(&found) - mean(&expected)).abs() < 1e-12, "{found}");
}

#[test]
fn damaged_files_are_refused_with_the_reason() {
    let array = include_bytes!("../data/glide-array.npy");
    let archive = include_bytes!("../data/glide-ball25.npz");
    let edited = |from: &str, to: &str| {
        let at = array
            .windows(from.len())
            .position(|part| part == from.as_bytes())
            .unwrap();
        [&array[..at], to.as_bytes(), &array[at + from.len()..]].concat()
    };
    let mut damaged = archive.to_vec();
    damaged[200] ^= 1;
    for (contents, words) in [
        (
            array[..800].to_vec(),
            "r: is not a valid .npy array: shape (30, 3) does not fit 672 bytes",
        ),
        (array[..50].to_vec(), "its header is damaged"),
        (b"\x1f\x8b\x08".to_vec(), "is compressed by gzip"),
        (b"PAR1\0".to_vec(), "is a Parquet file; save"),
        (b"x\0,\0y\0".to_vec(), "save it as UTF-8"),
        (
            edited("(30, 3)", "(3, 30)"),
            "has one column per reading; transpose it",
        ),
        (edited("(30, 3)", "(90,)  "), "is an array of shape (90)"),
        (edited("<f8", "<c8"), "has elements of type `<c8`"),
        (
            archive[..archive.len() - 30].to_vec(),
            "is not a valid zip archive: it is truncated or damaged",
        ),
        (damaged, "is damaged"),
        (
            b"[{\"x\":1,\"y\":2,\"z\":3},{\"x\":2,\"y\":2,\"z\":3}".to_vec(),
            "is no JSON object",
        ),
        (
            include_bytes!("../data/roll-series-side-by-side.npz").to_vec(),
            "reshape all arrays to 18 rows, and add an array `finger` or `probe`",
        ),
        (
            include_bytes!("../data/press-grid-with-axes.npz").to_vec(),
            "has the grid `normal_displacement_mm` of shape (11, 11)",
        ),
        (
            (0..99)
                .map(|name| format!("c{name},"))
                .collect::<String>()
                .into(),
            "`c49`, and 50 more; the columns must be",
        ),
        (
            b"{\"x\":[1,2],\"y\":[1]}".to_vec(),
            "columns of different lengths: `x` has 2 values, `y` has 1",
        ),
        (
            br#"{"x":{"0":1,"1":2},"y":{"0":1,"2":2},"z":{"0":1,"1":2}}"#.to_vec(),
            "`x` and `y` differ in the labels of their rows",
        ),
        (
            b"{\"x\":1,\"y\":2,\"z\":3}\n{\"x\":[1],\"y\":2,\"z\":3}".to_vec(),
            "r:2: has `x.0`, but the first row has `x`",
        ),
    ] {
        let error = glide(&contents, "").unwrap_err();
        assert!(error.contains(words), "{words}: {error}");
    }
    // Each inner list may contain the readings of several fingers or of several times. This must be an error.
    let list = |item: &str| format!("[{}]", [item; 6].join(","));
    let points = format!("{{\"points\":{}}}", list("[1,2,3]"));
    let axes = ["x", "y", "z"].map(|axis| format!("\"{axis}\":{}", list("1")));
    for item in [
        list(r#"{"x":1,"y":2,"z":3}"#),
        points,
        format!("{{{}}}", axes.join(",")),
    ] {
        let error = glide(list(&item), "").unwrap_err();
        assert!(
            error.contains("one list of readings, each with the key `finger`"),
            "{error}"
        );
    }
}
