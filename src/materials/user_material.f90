!> Interface to UMAT: Hughes-Winget kinematics, rotation of stress and strain, and the conversion of the Jaumann tangent.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Input of UMAT: committed stress, strain and state variables, and the strain increment; its output is the trial state.
!! At finite strain the increment follows Hughes and Winget: with the increment of displacement d and
!! the middle configuration x, G = dd/dx, DSTRAN = sym G, DROT = (1 - W/2)^-1 (1 + W/2), W = skw G; stress and strain at
!! the start are rotated by DROT. DDSDDE is (1/J) d(J s)/de of the Jaumann rate; the element needs the tangent of the
!! Lie derivative of tau = J s: c : D = J DDSDDE : D - D tau - tau D. It need not be symmetric.
!!
!! With an orientation all components refer to the local axes, which rotate with the increments of rotation: UMAT then
!! gets stress and strain unrotated, DROT = 1, DSTRAN in the axes at the end, and Q^T F Q with the axes Q of the start
!! for DFGRD0, of the end for DFGRD1.
!! References: T. J. R. Hughes, J. Winget, Int. J. Numer. Meth. Engng 15 (1980) 1862-1867; Abaqus User Subroutines
!! Reference Guide, UMAT. Theory: doc/theory/materials.md.
module amontons_user_material
  use amontons_kinds, only: DP
  use amontons_elasticity, only: lame_constants
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_logarithmic_strain, only: voigt_transformation
  use amontons_materials, only: material_type, USER_STRESS, USER_STRAIN, USER_GRADIENT, USER_ENERGY, &
    USER_ROTATION, USER_STATE
  use amontons_tensor, only: IDENTITY, determinant_minus_one, invert, pack_voigt, unpack_voigt
  use amontons_user_routines, only: umat_type, call_umat, USER_NAME_LENGTH
  implicit none
  private
  public :: umat_point_type, evaluate_umat, find_initial_tangent, transverse_energy, is_deleted, DELETED_STIFFNESS

  !> Data of a UMAT point beside strain and stress, input and output.
  type :: umat_point_type
    type(umat_type) :: values                      !< in: times, place, numbers; the rest is set here
    logical :: has_orientation = .false.                  !< local axes of an orientation, which rotate with the material
    real(DP) :: thermal(6, 2) = 0                  !< thermal strain at start and end, tensor components [-]
    real(DP), allocatable :: history_old(:)               !< committed, from USER_STRESS on, first is 1
    real(DP), allocatable :: history(:)            !< at the end of the increment
    real(DP), allocatable :: fields(:, :)          !< (n, 2) field variables and their changes; not there: none
  end type umat_point_type

  integer, parameter :: ABAQUS_ORDER(6) = [1, 2, 3, 4, 6, 5]   !< components here are xx yy zz xy yz xz, there 11 22 33 12 13 23
  real(DP), parameter :: DELETED_STIFFNESS = 1.0e-6_DP    !< of a deleted point over that at rest: slows no iteration [-]
  integer, parameter :: HISTORY_OFFSET = USER_STRESS - 1     !< number of history variables before those of umat_point_type

contains

  !> Stress, tangent and history of a point.
  pure subroutine evaluate_umat(material, is_nlgeom, H, strain, frame, user, stress, tangent, is_accepted)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    real(DP), intent(in) :: strain(6)              !< small strain, tensor components; not used under NLGEOM [-]
    real(DP), intent(in) :: frame(3, 3)            !< local axes in columns, at the start of the job
    type(umat_point_type), intent(inout) :: user
    real(DP), intent(out) :: stress(6)             !< small strain: stress; finite: Kirchhoff stress [stress]
    real(DP), intent(out) :: tangent(6, 6)         !< its derivative, spatial at finite strain [stress]
    logical, intent(out) :: is_accepted               !< .false.: UMAT requested a smaller increment or returned a non-finite number
    real(DP) :: volume, axes(3, 3)
    character(USER_NAME_LENGTH) :: name
    name = material%name
    user%history = user%history_old
    if (is_deleted(material, user%history_old(USER_STATE - HISTORY_OFFSET:))) then
      call delete_point(material, frame, user, stress, tangent)
      is_accepted = .true.
      return
    end if
    if (.not. allocated(user%fields)) allocate (user%fields(0, 2))
    associate (values => user%values, history => user%history)
      values%energies = history(USER_ENERGY - HISTORY_OFFSET:USER_ENERGY - HISTORY_OFFSET + 2)
      if (is_nlgeom) then
        call set_finite_increment(H, frame, user, axes)
      else
        axes = frame
        call set_small_increment(strain, frame, user)
      end if
      call call_umat(material%routines, name, material%props, history(USER_STATE - HISTORY_OFFSET:USER_STATE - HISTORY_OFFSET - &
        1 + material%n_statev), user%fields, values)
      is_accepted = values%is_accepted == 1 .and. all(abs(values%stress) <= huge(1.0_DP)) .and. &
        all(abs(values%ddsdde) <= huge(1.0_DP)) .and. all(abs(history(USER_STATE - HISTORY_OFFSET:)) <= huge(1.0_DP))
      if (.not. is_accepted) return
      if (is_deleted(material, history(USER_STATE - HISTORY_OFFSET:))) then
        call delete_point(material, frame, user, stress, tangent)
        return
      end if
      if (material%is_shell_law) call add_transverse_stress(material, is_nlgeom, user%history_old(USER_STRESS - HISTORY_OFFSET: &
        USER_STRESS - HISTORY_OFFSET + 5), values)
      history(USER_STRESS - HISTORY_OFFSET:USER_STRESS - HISTORY_OFFSET + 5) = values%stress
      history(USER_STRAIN - HISTORY_OFFSET:USER_STRAIN - HISTORY_OFFSET + 5) = values%stran + values%dstran
      history(USER_GRADIENT - HISTORY_OFFSET:USER_GRADIENT - HISTORY_OFFSET + 8) = reshape(H, [9])
      history(USER_ENERGY - HISTORY_OFFSET:USER_ENERGY - HISTORY_OFFSET + 2) = values%energies
      stress = values%stress(ABAQUS_ORDER)
      tangent = values%ddsdde(ABAQUS_ORDER, ABAQUS_ORDER)
    end associate
    if (user%has_orientation .or. .not. is_nlgeom) then
      stress = pack_voigt(rotate_tensor(axes, unpack_voigt(stress)))
      tangent = matmul(voigt_transformation(axes), matmul(tangent, transpose(voigt_transformation(axes))))
    end if
    if (is_nlgeom) then
      volume = 1 + determinant_minus_one(H)
      stress = volume * stress
      tangent = volume * tangent
      call convert_jaumann_to_lie(stress, tangent)
    end if
  end subroutine evaluate_umat


  !> Whether the state variable that deletes a point is zero.
  pure logical function is_deleted(material, statev)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: statev(:)
    is_deleted = .false.
    if (material%deletion > 0) is_deleted = .not. abs(statev(material%deletion)) > 0
  end function is_deleted


  !> A deleted point: no stress, and a tangent that keeps the matrix regular without any force.
  pure subroutine delete_point(material, frame, user, stress, tangent)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: frame(3, 3)            !< local axes in columns
    type(umat_point_type), intent(inout) :: user   !< out: stress and strain energy are zero
    real(DP), intent(out) :: stress(6), tangent(6, 6)   !< [stress]
    stress = 0
    tangent = DELETED_STIFFNESS * matmul(voigt_transformation(frame), matmul(material%at_rest, &
      transpose(voigt_transformation(frame))))
    user%values%stress = 0
    user%values%energies(1) = 0
    user%history(USER_STRESS - HISTORY_OFFSET:USER_STRESS - HISTORY_OFFSET + 5) = 0
    user%history(USER_ENERGY - HISTORY_OFFSET) = 0
  end subroutine delete_point


  !> What a law of the plane stress of shells does not give: the stresses 33, 13, 23 and their tangent, in the local axes.
  !!
  !! 13 and 23 are linear in their strains. 33 is free, so it is zero in the mean over the shell: at small strain it depends on its
  !! strain alone, and the thickness stays; at finite strain on the change of the volume, which stays, as in plane stress.
  pure subroutine add_transverse_stress(material, is_nlgeom, before, values)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: before(6)              !< stress at the start of the increment, 11 22 33 12 13 23 [stress]
    type(umat_type), intent(inout) :: values
    values%stress([3, 5, 6]) = before([3, 5, 6])
    associate (c => values%ddsdde, modulus => material%at_rest(3, 3))
      c(3, 3) = modulus
      if (is_nlgeom) c(3, :2) = modulus
      c(5:6, 5:6) = material%transverse_shear
      values%stress(3) = values%stress(3) + dot_product(c(3, :3), values%dstran(:3))
      values%stress(5:6) = values%stress(5:6) + matmul(material%transverse_shear, values%dstran(5:6))
    end associate
  end subroutine add_transverse_stress


  !> The elastic energy of these stresses.
  pure real(DP) function transverse_energy(material, stress) result(energy)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: stress(6)              !< 11 22 33 12 13 23 [stress]
    energy = 0
    if (.not. material%is_shell_law) return
    associate (G => material%transverse_shear, t => stress(5:6))
      energy = 0.5_DP * stress(3)**2 / material%at_rest(3, 3) + 0.5_DP * (G(2, 2) * t(1)**2 - (G(1, 2) + G(2, 1)) * t(1) * t(2) + &
        G(1, 1) * t(2)**2) / (G(1, 1) * G(2, 2) - G(1, 2) * G(2, 1))
    end associate
  end function transverse_energy


  !> The increment at small strain, in the local axes.
  pure subroutine set_small_increment(strain, frame, user)
    real(DP), intent(in) :: strain(6)
    real(DP), intent(in) :: frame(3, 3)
    type(umat_point_type), intent(inout) :: user
    associate (values => user%values, past => user%history_old)
      values%stress = past(USER_STRESS - HISTORY_OFFSET:USER_STRESS - HISTORY_OFFSET + 5)
      values%stran = past(USER_STRAIN - HISTORY_OFFSET:USER_STRAIN - HISTORY_OFFSET + 5)
      values%dstran = abaqus_engineering_components(matmul(transpose(frame), matmul(unpack_voigt(strain - user%thermal(:, 2)), &
        frame))) &
        - values%stran
      values%drot = IDENTITY
      values%dfgrd0 = IDENTITY
      values%dfgrd1 = IDENTITY
    end associate
  end subroutine set_small_increment


  !> The increment at finite strain; stress and strain at the start are rotated with the material, or the local axes are.
  pure subroutine set_finite_increment(H, frame, user, axes)
    real(DP), intent(in) :: H(3, 3)
    real(DP), intent(in) :: frame(3, 3)            !< local axes in columns, at the start of the job
    type(umat_point_type), intent(inout) :: user
    real(DP), intent(out) :: axes(3, 3)            !< local axes at the end of the increment
    real(DP) :: inverse(3, 3), change(3, 3), G(3, 3), W(3, 3), Q(3, 3), det
    associate (values => user%values, past => user%history_old)
      values%dfgrd0 = IDENTITY + reshape(past(USER_GRADIENT - HISTORY_OFFSET:USER_GRADIENT - HISTORY_OFFSET + 8), [3, 3])
      values%dfgrd1 = IDENTITY + H
      call invert(values%dfgrd0, inverse, det)
      change = matmul(values%dfgrd1 - values%dfgrd0, inverse)    ! F1 F0^-1 - 1
      call invert(IDENTITY + 0.5_DP * change, inverse, det)
      G = matmul(change, inverse)
      W = 0.5_DP * (G - transpose(G))
      call invert(IDENTITY - 0.5_DP * W, inverse, det)
      Q = matmul(inverse, IDENTITY + 0.5_DP * W)
      G = 0.5_DP * (G + transpose(G))
      if (user%has_orientation) then
        call rotate_axes(Q, frame, user, axes)
        values%dstran = abaqus_engineering_components(rotate_tensor(transpose(axes), G) - &
          rotate_tensor(transpose(frame), unpack_voigt(user%thermal(:, 2) - user%thermal(:, 1))))
        return
      end if
      axes = IDENTITY
      values%drot = Q
      values%stress = abaqus_tensor_components(rotate_tensor(Q, tensor_from_abaqus(past(USER_STRESS - HISTORY_OFFSET:USER_STRESS &
        - HISTORY_OFFSET + 5), 1.0_DP)))
      values%stran = abaqus_engineering_components(rotate_tensor(Q, &
        tensor_from_abaqus(past(USER_STRAIN - HISTORY_OFFSET:USER_STRAIN - HISTORY_OFFSET + 5), 0.5_DP)))
      values%dstran = abaqus_engineering_components(G - unpack_voigt(user%thermal(:, 2) - user%thermal(:, 1)))
    end associate
  end subroutine set_finite_increment


  !> Rotates the local axes with the material; stress, strain and deformation in these axes.
  pure subroutine rotate_axes(Q, frame, user, axes)
    real(DP), intent(in) :: Q(3, 3)                !< rotation of the increment
    real(DP), intent(in) :: frame(3, 3)            !< axes at the start of the job
    type(umat_point_type), intent(inout) :: user
    real(DP), intent(out) :: axes(3, 3)            !< at the end of the increment
    real(DP) :: rotation(3, 3), before(3, 3)
    associate (values => user%values, past => user%history_old)
      rotation = IDENTITY + reshape(past(USER_ROTATION - HISTORY_OFFSET:USER_ROTATION - HISTORY_OFFSET + 8), [3, 3])
      before = matmul(rotation, frame)
      rotation = matmul(Q, rotation)
      axes = matmul(rotation, frame)
      user%history(USER_ROTATION - HISTORY_OFFSET:USER_ROTATION - HISTORY_OFFSET + 8) = reshape(rotation - IDENTITY, [9])
      values%drot = IDENTITY
      values%stress = past(USER_STRESS - HISTORY_OFFSET:USER_STRESS - HISTORY_OFFSET + 5)
      values%stran = past(USER_STRAIN - HISTORY_OFFSET:USER_STRAIN - HISTORY_OFFSET + 5)
      values%dfgrd0 = rotate_tensor(transpose(before), values%dfgrd0)
      values%dfgrd1 = rotate_tensor(transpose(axes), values%dfgrd1)
    end associate
  end subroutine rotate_axes


  !> Q T Q^T.
  pure function rotate_tensor(Q, T) result(y)
    real(DP), intent(in) :: Q(3, 3), T(3, 3)
    real(DP) :: y(3, 3)
    y = matmul(Q, matmul(T, transpose(Q)))
  end function rotate_tensor


  !> A symmetric tensor from the components 11 22 33 12 13 23.
  pure function tensor_from_abaqus(x, shear) result(T)
    real(DP), intent(in) :: x(6)
    real(DP), intent(in) :: shear                  !< factor of the last three: 0.5 for engineering strains [-]
    real(DP) :: T(3, 3)
    T = reshape([x(1), shear * x(4), shear * x(5), shear * x(4), x(2), shear * x(6), shear * x(5), shear * x(6), x(3)], &
      [3, 3])
  end function tensor_from_abaqus


  !> The components 11 22 33 12 13 23 of a symmetric tensor.
  pure function abaqus_tensor_components(T) result(x)
    real(DP), intent(in) :: T(3, 3)
    real(DP) :: x(6)
    x = [T(1, 1), T(2, 2), T(3, 3), T(1, 2), T(1, 3), T(2, 3)]
  end function abaqus_tensor_components


  !> The same with engineering shears.
  pure function abaqus_engineering_components(T) result(x)
    real(DP), intent(in) :: T(3, 3)
    real(DP) :: x(6)
    x = abaqus_tensor_components(T)
    x(4:) = 2 * x(4:)
  end function abaqus_engineering_components


  !> c : D = c_J : D - D tau - tau D.
  pure subroutine convert_jaumann_to_lie(tau, c)
    real(DP), intent(in) :: tau(6)                 !< [stress]
    real(DP), intent(inout) :: c(6, 6)             !< in: of Jaumann's rate; out: of Lie's derivative [stress]
    real(DP) :: unit(6), D(3, 3), T(3, 3)
    integer :: k
    T = unpack_voigt(tau)
    do k = 1, 6
      unit = 0
      unit(k) = merge(1.0_DP, 0.5_DP, k <= 3)
      D = unpack_voigt(unit)
      c(:, k) = c(:, k) - pack_voigt(matmul(D, T) + matmul(T, D))
    end do
  end subroutine convert_jaumann_to_lie


  !> DDSDDE of the undeformed material: it stabilizes elements with one point. Called before the start, as Abaqus calls UMAT at the
  !! first point before the first increment.
  subroutine find_initial_tangent(material, at_rest, initial_statev, fields, error)
    type(material_type), intent(inout) :: material !< out: at_rest, youngs_modulus
    type(umat_type), intent(in) :: at_rest         !< arguments at a point, with the most components of the material's elements
    real(DP), intent(in) :: initial_statev(:)      !< there
    real(DP), intent(in) :: fields(:, :)           !< (n, 2) field variables there, and zero
    type(error_type), allocatable, intent(out) :: error
    type(umat_type) :: values
    real(DP) :: statev(size(initial_statev)), solid(6, 6)
    character(USER_NAME_LENGTH) :: name
    name = material%name
    values = at_rest
    statev = initial_statev
    call call_umat(material%routines, name, material%props, statev, fields, values)
    if (values%is_accepted == 0 .or. .not. all(abs(values%ddsdde) <= huge(1.0_DP))) then
      call set_error(error, EXIT_SETUP, 'UMAT gives no DDSDDE for the material ''' // material%name // &
        ''' at rest (no strain, initial STATEV): it calls XIT, or gives what is not finite.')
      return
    end if
    solid = values%ddsdde
    call complete_3d_tangent([at_rest%ndi, at_rest%nshr], solid)
    if (material%is_shell_law) then
      call complete_shell_tangent(material%transverse_shear, values%ddsdde)
    else
      values%ddsdde = solid
    end if
    material%at_rest = 0.5_DP * (values%ddsdde(ABAQUS_ORDER, ABAQUS_ORDER) + transpose(values%ddsdde(ABAQUS_ORDER, ABAQUS_ORDER)))
    associate (G => solid(4, 4), lambda => 0.5_DP * (solid(1, 2) + solid(2, 1)))
      if (G + lambda > 0) material%youngs_modulus = G * (3 * lambda + 2 * G) / (lambda + G)
      if (G + lambda > 0) material%poissons_ratio = lambda / (2 * (lambda + G))
    end associate
  end subroutine find_initial_tangent


  !> Adds the entries 33, 13, 23 of a law of shells: 33 is as stiff as 11 and 22, but not softer than the shear.
  pure subroutine complete_shell_tangent(shear, c)
    real(DP), intent(in) :: shear(2, 2)            !< [stress]
    real(DP), intent(inout) :: c(6, 6)             !< 11 22 33 12 13 23 [stress]
    c(3, 3) = max(0.5_DP * (c(1, 1) + c(2, 2)), 0.5_DP * (shear(1, 1) + shear(2, 2)))
    c(5:6, 5:6) = shear
  end subroutine complete_shell_tangent


  !> Adds tangent entries that a plane or uniaxial law does not provide, as if it were isotropic (uniaxial: with nu = 0.3).
  pure subroutine complete_3d_tangent(components, c)
    integer, intent(in) :: components(2)           !< NDI, NSHR
    real(DP), intent(inout) :: c(6, 6)             !< 11 22 33 12 13 23 [stress]
    real(DP) :: E, nu, lambda, G
    integer :: i
    if (components(2) == 3) return
    if (components(1) == 3) then
      c(5, 5) = c(4, 4)
      c(6, 6) = c(4, 4)
      return
    end if
    E = c(1, 1)
    nu = 0.3_DP
    if (components(1) == 2) then
      if (c(1, 1) > 0) nu = max(-0.9_DP, min(0.49_DP, c(1, 2) / c(1, 1)))
      E = c(1, 1) * (1 - nu**2)
    end if
    call lame_constants(E, nu, lambda, G)
    c = 0
    c(:3, :3) = lambda
    do i = 1, 3
      c(i, i) = lambda + 2 * G
      c(i + 3, i + 3) = G
    end do
  end subroutine complete_3d_tangent

end module amontons_user_material
