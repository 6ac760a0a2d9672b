C     Linear elasticity for whatever components there are: in plane stress and in bars with the stresses across zero. PROPS: E,
C     nu. STATEV(1): number of calls that changed it, STATEV(2): kept from the start. It stops if NDI and NSHR are not those of
C     PROPS(3) and PROPS(4), if these are given.
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),DDSDDE(NTENS,NTENS),
     1 DDSDDT(NTENS),DRPLDE(NTENS),STRAN(NTENS),DSTRAN(NTENS),TIME(2),
     2 PREDEF(1),DPRED(1),PROPS(NPROPS),COORDS(3),DROT(3,3),
     3 DFGRD0(3,3),DFGRD1(3,3),JSTEP(4)
      IF (NTENS.NE.NDI+NSHR) CALL XIT
      IF (NPROPS.GE.4) THEN
        IF (NDI.NE.NINT(PROPS(3)).OR.NSHR.NE.NINT(PROPS(4))) CALL XIT
      END IF
      E=PROPS(1)
      XNU=PROPS(2)
      G=E/(2.D0*(1.D0+XNU))
      DDSDDE=0.D0
      IF (NDI.EQ.3) THEN
        XLAM=2.D0*G*XNU/(1.D0-2.D0*XNU)
        DIAG=XLAM+2.D0*G
      ELSE IF (NDI.EQ.2) THEN
        XLAM=E*XNU/(1.D0-XNU**2)
        DIAG=E/(1.D0-XNU**2)
      ELSE
        XLAM=0.D0
        DIAG=E
      END IF
      DO I=1,NDI
        DO J=1,NDI
          DDSDDE(I,J)=XLAM
        END DO
        DDSDDE(I,I)=DIAG
      END DO
      DO I=NDI+1,NTENS
        DDSDDE(I,I)=G
      END DO
      DO I=1,NTENS
        DO J=1,NTENS
          STRESS(I)=STRESS(I)+DDSDDE(I,J)*DSTRAN(J)
        END DO
      END DO
      RETURN
      END
C     STATEV at the start: place and number of the point.
      SUBROUTINE SDVINI(STATEV,COORDS,NSTATV,NCRDS,NOEL,NPT,LAYER,KSPT)
      INCLUDE 'ABA_PARAM.INC'
      DIMENSION STATEV(NSTATV),COORDS(NCRDS)
      STATEV(1)=COORDS(1)+10.D0*COORDS(2)
      STATEV(2)=100.D0*NOEL+NPT
      RETURN
      END
