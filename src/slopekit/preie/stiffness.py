"""tmp dense"""
import numpy as np
from scipy.linalg import lapack
from slopekit.errors import Fault, SolverError
class Stiffness:
    def __init__(self, model):
        self.model=model; n,u=model.load.shape; self.N=n*u
        if n*u>400:
            from slopekit.preie.banded import BandedStiffness
            self.band=BandedStiffness(model)
        else: self.band=None
        a,b=np.divmod(np.arange(u*u),u)
        both=model.minus>=0; self.both=both
        P,M=model.plus,model.minus[both]
        f=lambda r,c:(r[:,None]*u+a)*self.N+(c[:,None]*u+b)
        self.index=np.concatenate([f(P,P).ravel(),f(M,M).ravel(),f(M,P[both]).ravel(),f(P[both],M).ravel()])
        self.PT=model.plus_motion.transpose(0,2,1).copy(); self.MT=model.minus_motion[both].transpose(0,2,1).copy(); self.Mm=model.minus_motion[both]
    def dense(self, local):
        m=self.model; both=self.both
        onp=local@m.plus_motion; onm=local[both]@self.Mm
        vals=np.concatenate([(self.PT@onp).ravel(),(self.MT@onm).ravel(),(self.MT@onp[both]).ravel(),(self.PT[both]@onm).ravel()])
        return np.bincount(self.index,vals,self.N*self.N).reshape(self.N,self.N)
    def factored(self, local, shift, symmetric=True, inertia=None):
        if self.band is not None: return self.band.factored(local, shift, symmetric, inertia)
        m=self.model; both=self.both
        onp=local@m.plus_motion; onm=local[both]@self.Mm
        vals=np.concatenate([(self.PT@onp).ravel(),(self.MT@onm).ravel(),(self.MT@onp[both]).ravel(),(self.PT[both]@onm).ravel()])
        K=np.bincount(self.index,vals,self.N*self.N).reshape(self.N,self.N)
        d=np.einsum('ii->i',K); d+=shift*(np.abs(d)+np.abs(d).mean())
        if inertia is not None: d+=inertia
        lu,piv,info=lapack.dgetrf(K.T, overwrite_a=1)
        if info!=0: raise SolverError([Fault("E505","singular")])
        def solve(b):
            x,_=lapack.dgetrs(lu,piv,b,trans=1); return x
        return solve
