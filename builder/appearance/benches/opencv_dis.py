"""Compares our flow with OpenCV's DIS at its medium preset, on pairs that `--example flow_pair` wrote.

    pip install numpy opencv-python-headless
    python opencv_dis.py FOLDER
"""
import cv2, numpy as np, sys, time, glob
d=sys.argv[1]
for p in sorted(glob.glob(d+'/*.flow')):
    b=p[:-5]
    a=cv2.imread(b+'_0.png',0); c=cv2.imread(b+'_1.png',0)
    h,w=a.shape
    ours=np.fromfile(p,np.float32).reshape(h,w,2)
    truth=np.fromfile(b+'.truth',np.float32).reshape(h,w,2)
    dis=cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    for _ in range(3):
        t=time.time(); f=dis.calc(a,c,None); t=time.time()-t
    m=np.isfinite(truth[...,0])
    def e(f):
        x=np.sqrt(((f-truth)**2).sum(-1))[m]; return '%.3f/%.3f/%.3f'%(x.mean(),np.median(x),np.quantile(x,.9))
    print(b,'cv ms',round(t*1e3,1),'EPE mean/median/90: zero',e(np.zeros_like(f)),'ours',e(ours),'dis',e(f), 'known',m.mean())
