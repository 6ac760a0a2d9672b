! Three field variables by Abaqus's argument list, by the name of the material: GRADED x of the point; BROKEN 1 once the stress along x
! was above 5.5 at the start of an increment (kept in STATEV(1), STATEV(2) counts the increments), 0 before; SLOW 0, for which no
! increment may be longer than 0.05.
subroutine usdfld(field, statev, pnewdt, direct, t, celent, time, dtime, cmname, orname, nfield, nstatv, noel, npt, layer, kspt, &
  kstep, kinc, ndi, nshr, coord, jmac, jmatyp, matlayo, laccfla)
  include 'aba_param.inc'
  character(80) :: cmname, orname
  character(3) :: flgray(15)
  dimension field(nfield), statev(nstatv), direct(3, 3), t(3, 3), time(2), coord(*), jmac(*), jmatyp(*), array(15), jarray(15)
  select case (cmname)
  case ('GRADED')
    field(1) = coord(1)
  case ('BROKEN')
    call getvrm('S', array, jarray, flgray, jrcd, jmac, jmatyp, matlayo, laccfla)
    if (jrcd /= 0) call xit
    if (array(1) > 5.5d0) statev(1) = 1
    statev(2) = statev(2) + 1
    field(1) = statev(1)
  case ('SLOW')
    field(1) = 0
    if (dtime > 0.05d0) pnewdt = 0.5d0
  case ('STOPPED')
    call xit
  end select
end subroutine usdfld
