use builder::performer::*;
use glam::{Vec3,Quat};
fn main(){
  let t=std::time::Instant::now();
  let m=rest_mesh(5000);
  println!("{} v {} f euler {} {:?} vol {} area {} in {:?}", m.positions.len(), m.triangles.len(), m.euler_characteristic(), m.check_closed(), m.volume(), m.area(), t.elapsed());
  let (w,h)=(700usize,900usize);
  let mut img=image::RgbImage::from_pixel((w*3) as u32,h as u32,image::Rgb([230,230,230]));
  for (k,yaw) in [0.0f32,0.7,2.6].iter().enumerate(){
    let q=Quat::from_rotation_y(*yaw);
    let mut z=vec![f32::MIN;w*h];
    for tr in &m.triangles{
      let p=tr.map(|v|{let p=q*m.positions[v as usize];Vec3::new(w as f32*0.5+p.x*480.0,h as f32-25.0-p.y*480.0,p.z)});
      let wp=tr.map(|v|q*m.positions[v as usize]);
      let n=(wp[1]-wp[0]).cross(wp[2]-wp[0]).normalize();
      let l=0.35+0.65*n.dot(Vec3::new(0.4,0.6,0.7).normalize()).max(0.0);
      let area=(p[1].x-p[0].x)*(p[2].y-p[0].y)-(p[1].y-p[0].y)*(p[2].x-p[0].x);
      let (x0,x1)=(p.iter().map(|a|a.x).fold(1e9,f32::min).max(0.0) as usize,p.iter().map(|a|a.x).fold(0.0,f32::max).min(w as f32-1.0) as usize);
      let (y0,y1)=(p.iter().map(|a|a.y).fold(1e9,f32::min).max(0.0) as usize,p.iter().map(|a|a.y).fold(0.0,f32::max).min(h as f32-1.0) as usize);
      for y in y0..=y1{for x in x0..=x1{
        let (fx,fy)=(x as f32+0.5,y as f32+0.5);
        let e=|a:Vec3,b:Vec3|(b.x-a.x)*(fy-a.y)-(b.y-a.y)*(fx-a.x);
        let (b0,b1,b2)=(e(p[1],p[2])/area,e(p[2],p[0])/area,e(p[0],p[1])/area);
        if b0<0.0||b1<0.0||b2<0.0{continue}
        let d=b0*p[0].z+b1*p[1].z+b2*p[2].z;
        if d>z[y*w+x]{z[y*w+x]=d;
          let edge=b0.min(b1).min(b2);
          let c=if area>0.0 {[1.0,0.2,0.2]} else {[0.9,0.85,0.8]};
          let l=if edge<0.04 {l*0.75}else{l};
          img.put_pixel((x+k*w) as u32,y as u32,image::Rgb(c.map(|c:f32|(c*l*255.0) as u8)));}
      }}
    }
  }
  img.save("/tmp/perf_rest.png").unwrap();
}
