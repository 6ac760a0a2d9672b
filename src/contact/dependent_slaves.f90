!> Contact at slave nodes that equations, couplings and rigid bodies move: a penalty in place of exact contact.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Exact contact takes the force on a slave node from the balance of that node. A dependent node has no balance of its own: its
!! forces act on the nodes that move it. A pair with such slave nodes takes p = K h, h the overclosure, whose force every node can
!! have. With K = 100 E/a, E the modulus of the softer body and a the mean edge, h is a hundredth of the shortening of an element.
!! See doc/theory/contact.md, section 6.
module amontons_dependent_slaves
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_text, only: to_text, plural, NEWLINE
  use amontons_model, only: model_type
  use amontons_surfaces, only: interaction_type, surface_type, is_compliant, swap_advice, BEHAVIOR_LINEAR
  use amontons_constraints, only: constraints_type, reset_constraints, prescribe_unknown, add_constraint_row, constraint_row_type
  use amontons_nonlinear_mpc, only: add_nonlinear_mpcs
  use amontons_structural_data, only: following_nodes
  use amontons_tributary_areas, only: add_nodal_face_areas, find_mean_edge_length
  use amontons_elasticity, only: small_strain_modulus
  implicit none
  private
  public :: find_penalties, penalty_law

  real(DP), parameter :: PENALTY_RATIO = 100.0_DP      !< K over E/a: the overclosure is 1 % of an element's shortening [-]
  real(DP), parameter :: MIN_DEPENDENT_PART = 1.0e-6_DP    !< a normal with a smaller dependent part is free [-]

contains

  !> The penalties of exact pairs with dependent slave nodes.
  subroutine find_penalties(model, stiffness, text)
    type(model_type), intent(in) :: model
    real(DP), allocatable, intent(out) :: stiffness(:)   !< (n_pairs) K; 0: no dependent slave node [stress/length]
    character(:), allocatable, intent(out) :: text   !< one line for each such pair; '' without any
    logical, allocatable :: is_dependent(:, :)     ! (3, n_nodes)
    integer, allocatable :: found(:)
    integer :: p
    text = ''
    allocate (stiffness(size(model%pairs)), source=0.0_DP)
    if (all(is_compliant(model%interactions(model%pairs%interaction))) .or. size(model%steps) == 0) return
    call find_dependent_unknowns(model, is_dependent)
    if (.not. any(is_dependent)) return
    do p = 1, size(model%pairs)
      associate (pair => model%pairs(p))
        if (is_compliant(model%interactions(pair%interaction))) cycle
        call find_dependent_slaves(model, p, is_dependent, found)
        if (size(found) == 0) cycle
        stiffness(p) = penalty_stiffness(model, p, is_dependent)
        if (stiffness(p) <= 0.0_DP) cycle          ! no modulus: the check before the run names the nodes
        if (text /= '') text = text // NEWLINE
        text = text // 'The contact pair ' // model%surfaces(pair%slave)%name // ' / ' // model%surfaces(pair%master)%name // &
          ' acts by a penalty of ' // to_text(stiffness(p)) // ' [stress/length]: equations, couplings or rigid bodies move ' // &
          plural(size(found), 'slave node') // ' (' // to_text(model%mesh%node_label(found(1))) // &
          trim(merge(', ...', '     ', size(found) > 1)) // ').'
        if (min_modulus(model, model%surfaces(pair%master), is_dependent) < huge(1.0_DP)) text = text // &
          ' ' // swap_advice(pair) // ' for exact contact.'
      end associate
    end do
  end subroutine find_penalties


  !> The law with a penalty normal and tangential to the surface.
  pure type(interaction_type) function penalty_law(law, stiffness) result(penalty)
    type(interaction_type), intent(in) :: law
    real(DP), intent(in) :: stiffness              !< [stress/length]
    penalty = law
    penalty%behavior = BEHAVIOR_LINEAR
    penalty%is_penalty = .true.
    penalty%stiffness = stiffness
    penalty%stick_slope = stiffness
  end function penalty_law


  !> The unknowns that *EQUATION, *MPC, couplings, rigid bodies and the solid of a composite shell express by others in step 1.
  !! Those of ties and pre-tension sections are not among them: their slaves lie beside nodes that have the contact of both.
  subroutine find_dependent_unknowns(model, is_dependent)
    type(model_type), intent(in) :: model
    logical, allocatable, intent(out) :: is_dependent(:, :)   !< (3, n_nodes)
    type(constraints_type) :: base
    type(constraint_row_type) :: row
    type(error_type), allocatable :: error
    real(DP), allocatable :: u(:, :)
    real(DP) :: violation
    integer :: i, verdict
    call reset_constraints(base, 3 * model%mesh%n_nodes)
    do i = 1, size(model%steps(1)%prescribed)
      associate (load => model%steps(1)%prescribed(i))
        call prescribe_unknown(base, 3 * (load%node - 1) + load%dof, 0.0_DP)
      end associate
    end do
    do i = 1, size(model%equations)
      associate (equation => model%equations(i))
        if (.not. any(equation%card == [character(24) :: 'EQUATION', 'MPC'])) cycle
        row%unknown = 3 * (equation%node - 1) + equation%dof
        row%coefficient = equation%coefficient
        call add_constraint_row(base, row, equation%n_eliminable, huge(1.0_DP), verdict)
      end associate
    end do
    allocate (u(3, model%mesh%n_nodes), source=0.0_DP)
    call add_nonlinear_mpcs(base, model, u, model%steps(1)%is_nlgeom, violation, error)   ! contradictions: the first increment
    is_dependent = reshape(base%owner > 0, [3, model%mesh%n_nodes]) .or. spread(following_nodes(model%structure, &
      model%mesh%n_nodes), 1, 3)
  end subroutine find_dependent_unknowns


  !> The slave nodes of a pair that others move in a direction in which contact acts on them: along the normal, with friction any.
  subroutine find_dependent_slaves(model, p, is_dependent, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: p                       !< pair
    logical, intent(in) :: is_dependent(:, :)      !< (3, n_nodes)
    integer, allocatable, intent(out) :: found(:)  !< nodes
    real(DP), allocatable :: area_vector(:, :), area(:)
    integer, allocatable :: corners(:, :)
    logical, allocatable :: is_found(:)
    integer :: f, i, n
    associate (mesh => model%mesh, surface => model%surfaces(model%pairs(p)%slave), &
      law => model%interactions(model%pairs(p)%interaction))
      allocate (area_vector(3, mesh%n_nodes), area(mesh%n_nodes), source=0.0_DP)
      allocate (corners(2, mesh%n_nodes), source=0)
      if (.not. surface%is_node_based) then
        do f = 1, size(surface%element)
          call add_nodal_face_areas(mesh, surface%element(f), surface%face(f), .true., area_vector, area, corners)
        end do
      end if
      allocate (is_found(size(surface%nodes)))
      do i = 1, size(surface%nodes)
        n = surface%nodes(i)
        is_found(i) = any(is_dependent(:, n))
        if (.not. is_found(i) .or. law%friction > 0.0_DP .or. law%is_user_friction .or. surface%is_node_based) cycle
        is_found(i) = norm2(merge(area_vector(:, n), 0.0_DP, is_dependent(:, n))) > MIN_DEPENDENT_PART * norm2(area_vector(:, n))
      end do
      found = pack(surface%nodes, is_found)
    end associate
  end subroutine find_dependent_slaves


  !> K of a pair: by the softer of the bodies that deform, or of both if none does; by the finer mesh.
  real(DP) function penalty_stiffness(model, p, is_dependent) result(stiffness)
    type(model_type), intent(in) :: model
    integer, intent(in) :: p                       !< pair
    logical, intent(in) :: is_dependent(:, :)      !< (3, n_nodes)
    real(DP) :: modulus, edge
    associate (slave => model%surfaces(model%pairs(p)%slave), master => model%surfaces(model%pairs(p)%master))
      modulus = min(min_modulus(model, slave, is_dependent), min_modulus(model, master, is_dependent))
      if (modulus >= huge(1.0_DP)) modulus = min(min_modulus(model, slave, .false. .and. is_dependent), &
        min_modulus(model, master, .false. .and. is_dependent))
      if (modulus >= huge(1.0_DP)) modulus = 0.0_DP
      edge = min(mean_edge(slave), mean_edge(master))
      if (edge >= huge(1.0_DP)) modulus = 0.0_DP
      stiffness = PENALTY_RATIO * modulus / edge
    end associate

  contains

    !> The mean edge of the faces; huge without faces.
    real(DP) function mean_edge(surface)
      type(surface_type), intent(in) :: surface
      mean_edge = huge(1.0_DP)
      if (allocated(surface%element)) mean_edge = find_mean_edge_length(model%mesh, surface, mean_edge)
    end function mean_edge

  end function penalty_stiffness


  !> The least Young's modulus of the elements below a surface that deform; huge if none does.
  pure real(DP) function min_modulus(model, surface, is_dependent) result(modulus)
    type(model_type), intent(in) :: model
    type(surface_type), intent(in) :: surface
    logical, intent(in) :: is_dependent(:, :)      !< (3, n_nodes)
    real(DP) :: e
    integer :: f, material
    modulus = huge(1.0_DP)
    if (.not. allocated(surface%element)) return
    do f = 1, size(surface%element)
      associate (mesh => model%mesh, i => surface%element(f))
        material = mesh%material(i)
        if (material == 0 .or. all(is_dependent(:, mesh%nodes(mesh%first(i):mesh%first(i + 1) - 1)))) cycle
      end associate
      e = small_strain_modulus(model%materials(material))
      if (e > 0.0_DP) modulus = min(modulus, e)
    end do
  end function min_modulus

end module amontons_dependent_slaves
