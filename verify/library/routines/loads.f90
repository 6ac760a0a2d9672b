! DLOAD: a pressure linear in x, y and time; DISP: a displacement linear in place and time; UAMP: the sum of the time
! increments so far, kept in svars(1), times props(1).
subroutine dload(f, kstep, kinc, time, noel, npt, layer, kspt, coords, jltyp, sname)
  include 'aba_param.inc'
  dimension time(2), coords(3)
  character(80) :: sname
  f = (10 + 4 * coords(1) - 2 * coords(2)) * time(1)
  if (jltyp < 21 .or. jltyp > 26) call xit
  if (kstep < 1 .or. kinc < 1 .or. noel < 1 .or. npt < 1) call xit
end subroutine dload

subroutine disp(u, kstep, kinc, time, node, noel, jdof, coords)
  include 'aba_param.inc'
  dimension u(3), time(3), coords(3)
  if (jdof == 3) u(1) = -0.001d0 * time(1)
  if (jdof == 1) u(1) = 0.002d0 * time(1)
  if (time(3) <= 0 .or. node < 1) call xit
end subroutine disp

subroutine uamp(ampname, time, ampvalueold, dt, nprops, props, nsvars, svars, lflagsinfo, nsensor, sensorvalues, sensornames, &
  jsensorlookuptable, ampvaluenew, lflagsdefine, ampderivative, ampsecderivative, ampincintegral, ampdoubleintegral)
  include 'aba_param.inc'
  dimension time(2), props(nprops), svars(nsvars), sensorvalues(1), jsensorlookuptable(1), lflagsinfo(4), lflagsdefine(4)
  character(80) :: ampname, sensornames(1)
  if (ampname /= 'RAMP') call xit
  if (lflagsinfo(1) == 1) then
    svars(1) = 0
    ampvaluenew = 0
    return
  end if
  svars(1) = svars(1) + dt
  ampvaluenew = props(1) * svars(1)
  if (abs(svars(1) - time(2)) > 1d-12) call stdb_abqerr(-3, 'the sum of the increments is %R', 0, svars(1), ' ')
end subroutine uamp
