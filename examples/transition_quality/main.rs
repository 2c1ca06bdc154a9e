//! x
mod quality;
use quality::{Bench, Pair};
fn main() {
    let folder = std::env::args().nth(1);
    let open = |folder: &Option<String>| match folder.as_deref() { Some("made") | None => Bench::made().unwrap(), Some(f) => Bench::open(f.as_ref(), |_| true).unwrap() };
    let ids = open(&folder).ids;
    eprintln!("{ids:?}");
    let n = 2;
    let pairs: Vec<(usize, usize)> = (0..ids.len()).flat_map(|a| (0..ids.len()).map(move |b| (a, b))).collect();
    let mut out: Vec<Pair> = std::thread::scope(|s| {
        let hs: Vec<_> = (0..n).map(|k| { let (pairs, folder, ids) = (&pairs, &folder, &ids); s.spawn(move || { let mut bench = open(folder);
            pairs.iter().skip(k).step_by(n).map(|&(a, b)| bench.pair(&ids[a], &ids[b]).unwrap()).collect::<Vec<_>>() }) }).collect();
        hs.into_iter().flat_map(|h| h.join().unwrap()).collect()
    });
    out.sort_by(|x, y| (&x.a, &x.b).cmp(&(&y.a, &y.b)));
    for p in &out {
        let worst = |v: &Vec<f32>| v.iter().copied().fold(0.0, f32::max);
        println!("{:>8} {:<8} {:4} {:4} d{:5.1} seam {:5.2} {:10} {:6.0} x{:5.2} ctl {:5.2} pool {:5.2} over {:5.2} {:10} @{:<3} met {:5.0} spin {:5.1} skate {:5.2} {:5.2} st {:5.2} {:5.2} knee {:4.2} {:4.2}",
            p.a.split('~').next().unwrap(), p.b.split('~').next().unwrap(), p.leave, p.enter, p.distance_cm, p.seam, p.seam_joint, p.seam_dps, p.seam_x, p.control, p.pooled, p.over, p.over_joint, p.over_frame, p.metric_dps, p.spin,
            p.skate[0], p.skate[1], worst(&p.stances[0]), worst(&p.stances[1]), p.knee, p.knee_free);
    }
    let n = out.len();
    let count = |f: &dyn Fn(&Pair) -> bool| out.iter().filter(|p| f(p)).count();
    let median = |mut v: Vec<f64>| { v.retain(|x| x.is_finite()); v.sort_by(f64::total_cmp); v[v.len() / 2] };
    println!("{n} pairs; seam<=1 {} x {} control {} pooled {} over {} metric0 {}", count(&|p| p.seam <= 1.0), count(&|p| p.seam_x <= 1.0), count(&|p| p.control <= 1.0), count(&|p| p.pooled <= 1.0), count(&|p| p.over <= 1.0), count(&|p| p.metric_dps <= 0.0));
    println!("spin <1 {} <3 {} <6 {} <15 {}", count(&|p| p.spin < 1.0), count(&|p| p.spin < 3.0), count(&|p| p.spin < 6.0), count(&|p| p.spin < 15.0));
    for k in 0..2 {
        println!("skate median of worst {:.3}, stance median {:.3} worst {:.2}", median(out.iter().map(|p| p.skate[k]).collect()), median(out.iter().flat_map(|p| p.stances[k].iter().map(|&x| f64::from(x))).collect()), out.iter().map(|p| p.skate[k]).fold(0.0, f64::max));
    }
    println!("-90%: {} of {} with skate", count(&|p| p.skate[0] > 0.0 && p.skate[1] <= 0.1 * p.skate[0]), count(&|p| p.skate[0] > 0.0));
    println!("-90% of those above 0.5cm: {} of {}", count(&|p| p.skate[0] > 0.5 && p.skate[1] <= 0.1 * p.skate[0]), count(&|p| p.skate[0] > 0.5));
    println!("knee >1.5 {} free>1.5 {}", count(&|p| p.knee > 1.5), count(&|p| p.knee_free > 1.5));
}
