//! x
use segue::blend::Source;

use segue::session::{Command, Session};
fn main() {
    let folder = std::path::PathBuf::from(std::env::args().nth(1).unwrap());
    let mut s = Session::new();
    let mut load = |n: &str| { s.load(n, std::fs::read(folder.join(n)).unwrap().into()).unwrap() };
    load("16.asf");
    let mut ids = vec![];
    let names: Vec<String> = std::env::args().skip(2).collect();
    for n in &names { ids.push(load(&format!("16_{n}.amc")).ids[0].clone()); }
    for pair in ids.chunks(2) {
        s.apply(Command::OpenLink(format!("lab=transition&a={}&b={}", pair[0], pair[1]))).unwrap();
        while s.work() {}
        let o = s.panes()[0].outcome.clone().unwrap();
        let t = o.transition.unwrap();
        let f = |x: f64| (x * 120.0).round() as usize;
        let (start, enter) = (f(t.start_secs), f(t.enter_b_secs));
        let src: Vec<Source> = o.sources.iter().map(|m| Source::with_frames(m.motion.clip.clone(), &m.motion.roles, m.motion.ground_frames.clone())).collect();
        let r = Source::with_frames(o.motion.clip.clone(), &o.motion.roles, o.motion.ground_frames.clone());
        let free = Source::new(o.motion.clip.clone(), &o.motion.roles);
        println!("{pair:?} leave {start} of {} enter {enter} of {} window {}", src[0].frames().len(), src[1].frames().len(), t.window_frames);
        let rate = |s: &Source, f: usize| if f > 0 && f < s.frames().len() { { let d = s.frames()[f].yaw - s.frames()[f-1].yaw; d.sin().atan2(d.cos()) }.to_degrees() * 120.0 } else { f64::NAN };
        let (mut sum, mut sa, mut sb) = (0.0, 0.0, 0.0);
        for k in 0..100usize {
            let fr = start + k;
            sum += rate(&free, fr) / 120.0; if rate(&src[0], fr).is_finite() { sa += rate(&src[0], fr)/120.0; } sb += rate(&src[1], enter + k)/120.0;
            if k % 6 == 0 { println!("  {k:3} r {:7.1} measured {:7.1} a {:7.1} b {:7.1} | turned r {:6.1} a {:6.1} b {:6.1}", rate(&r, fr), rate(&free, fr), rate(&src[0], fr), rate(&src[1], enter + k), sum, sa, sb); }
        }
    }
}
